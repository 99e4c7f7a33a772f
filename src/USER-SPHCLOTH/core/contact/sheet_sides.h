// SPDX-License-Identifier: GPL-2.0-or-later
// On which side of each sheet a particle is, for sheets that are near it.

#ifndef SPHCLOTH_CORE_CONTACT_SHEET_SIDES_H
#define SPHCLOTH_CORE_CONTACT_SHEET_SIDES_H

#include <cstdint>

namespace sphcloth {

// bits 0 to 7: above sheet 0 to 7, the side from which its triangles run counter-clockwise;
// bits 8 to 15: below it

using Sides = std::uint32_t;

inline constexpr int MAX_SHEETS = 8;

// a sheet is near, which may have its border there, without a side; more than one layer is near
inline constexpr Sides NEAR_SHEET = 1u << 16, LAYERED = 1u << 17;

inline Sides side_of_sheet(int sheet, bool above)
{
  return 1u << (above ? sheet : sheet + MAX_SHEETS);
}

// is there a sheet between the two?

inline bool parted(Sides a, Sides b)
{
  const Sides above_a = a & 0xffu, below_a = a >> MAX_SHEETS & 0xffu;
  const Sides above_b = b & 0xffu, below_b = b >> MAX_SHEETS & 0xffu;
  return ((above_a & below_b) | (below_a & above_b)) != 0;
}

// Decides where sides alone do not: SheetLayers.

class Parting {
 public:
  // of two particles, both as of the last list build
  virtual bool part(int i, int j, Sides of_i, Sides of_j) = 0;

 protected:
  ~Parting() = default;
};

// is that needed?  A particle without any sheet near it is not parted.

inline bool are_doubtful(Sides a, Sides b)
{
  return parted(a, b) || ((a | b) & LAYERED && a & b & NEAR_SHEET);
}

}    // namespace sphcloth

#endif
