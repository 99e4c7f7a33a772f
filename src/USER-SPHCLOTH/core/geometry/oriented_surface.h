// SPDX-License-Identifier: GPL-2.0-or-later
// A set of triangles as oriented surfaces: its parts that hang together by edges, all triangles of
// a part turned alike, and the loops of edges that bound its holes.

#ifndef SPHCLOTH_CORE_GEOMETRY_ORIENTED_SURFACE_H
#define SPHCLOTH_CORE_GEOMETRY_ORIENTED_SURFACE_H

#include <array>
#include <vector>

namespace sphcloth {

struct OrientedSurface {
  enum class Flaw { NONE, BRANCHED, ONE_SIDED };

  // Triangles of the same vertices are one.  A part is turned as most of its triangles were.
  explicit OrientedSurface(std::vector<std::array<int, 3>> triangles);

  std::vector<std::array<int, 3>> triangles;    // ascending by their vertices
  std::vector<int> part;                        // of each triangle
  std::vector<int> first;    // smallest vertex of each part, ascending

  struct Hole {
    int part;
    std::vector<int> loop;    // its vertices, along the edges of the triangles
  };
  std::vector<Hole> holes;

  // An edge with more than two triangles, or one at which the triangles of a one-sided surface
  // meet.  Then there are no holes, and parts may be wrong.
  Flaw flaw = Flaw::NONE;
  std::array<int, 2> flawed_edge{};

  int parts() const { return static_cast<int>(first.size()); }
  bool is_closed(int of_part) const;

 private:
  struct Side;    // of a triangle
  std::vector<Side> sides() const;
  void find_parts(const std::vector<Side> &);
  void find_holes(const std::vector<Side> &);
  void set_flaw(Flaw, const Side &);
};

}    // namespace sphcloth

#endif
