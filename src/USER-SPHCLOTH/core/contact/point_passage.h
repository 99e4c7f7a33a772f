// SPDX-License-Identifier: GPL-2.0-or-later
// Where a moving point passes through a moving triangle.

#ifndef SPHCLOTH_CORE_CONTACT_POINT_PASSAGE_H
#define SPHCLOTH_CORE_CONTACT_POINT_PASSAGE_H

#include "core/contact/additive_ccd.h"

#include <optional>

namespace sphcloth {

// of the first point over the plane of the others, times twice the area of their triangle

inline double height_over(const FourPoints &x)
{
  return (x[2] - x[1]).cross(x[3] - x[1]).dot(x[0] - x[1]);
}

// Does a point end a step on the other side of a triangle, and pass through that?  If so, the
// barycentric coordinates of where it does.  When it is in the plane: by regula falsi, Illinois
// variant (Dowell & Jarratt, BIT 11 (1971) 168).  Passing through twice is not seen.

inline std::optional<Vec3> passage(const PairMotion &pair)
{
  constexpr int MAX_STEPS = 60;
  constexpr double ROUND_OFF = 1e-14;
  double from = 0.0, to = 1.0, height_from = height_over(pair.at(from)),
         height_to = height_over(pair.at(to));
  if (height_from == 0.0 || height_from * height_to > 0.0) return std::nullopt;
  const double height_at_start = std::fabs(height_from);
  double time = to, height = height_to;
  int last_moved = 0;    // end of the interval: -1 or 1
  for (int n = 0; n < MAX_STEPS && std::fabs(height) > ROUND_OFF * height_at_start; n++) {
    time = (from * height_to - to * height_from) / (height_to - height_from);
    height = height_over(pair.at(time));
    if (height * height_from > 0.0) {
      from = time;
      height_from = height;
      if (last_moved == -1) height_to *= 0.5;
      last_moved = -1;
    } else {
      to = time;
      height_to = height;
      if (last_moved == 1) height_from *= 0.5;
      last_moved = 1;
    }
  }
  const FourPoints x = pair.at(time);
  Vec3 weight = barycentric(x[0], x[1], x[2], x[3]);
  if (!inside(weight)) return std::nullopt;
  weight = weight.cwiseMax(0.0);
  return weight / weight.sum();
}

}    // namespace sphcloth

#endif
