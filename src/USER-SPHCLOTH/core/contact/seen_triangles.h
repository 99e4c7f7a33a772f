// SPDX-License-Identifier: GPL-2.0-or-later
// Triangles as they are seen from a point, in columns: which of them may a line from there cross?

#ifndef SPHCLOTH_CORE_CONTACT_SEEN_TRIANGLES_H
#define SPHCLOTH_CORE_CONTACT_SEEN_TRIANGLES_H

#include "core/contact/point_triangle.h"
#include "core/util/bytes.h"
#include "core/util/simd.h"

#include <array>
#include <cstddef>
#include <vector>

namespace sphcloth {

class SeenTriangles {
 public:
  void clear()
  {
    numbers.clear();
    for (auto &column : columns) column.clear();
  }

  // with vectors from the point to the corners
  void add(int number, const Vec3 &a, const Vec3 &b, const Vec3 &c)
  {
    const Vec3 normal = (b - a).cross(c - a);
    numbers.push_back(number);
    store({normal, a.cross(b), b.cross(c), c.cross(a)}, normal.dot(a), ROOM * normal.norm());
  }

  // behind the last one: up to whole groups, with what no line crosses
  void fill_up()
  {
    const Vec3 zero = Vec3::Zero();
    while (columns[HEIGHT].size() % LANES != 0) store({zero, zero, zero, zero}, 0.0, 0.0);
  }

  // Numbers, in the order in which they were added; all that the line crosses are among them, also
  // by round-off.  One that ends on a triangle, or lies in its plane, does not cross it.
  SPHCLOTH_MULTIVERSION const std::vector<int> &may_cross(const Vec3 &line)
  {
    const double lx = line[0], ly = line[1], lz = line[2], length = line.norm();
    found.clear();
    for (std::size_t n = 0; n < columns[HEIGHT].size(); n += LANES) {
      std::array<const double *, N> of;
      for (std::size_t c = 0; c < N; c++) of[c] = &columns[c][n];
      double may[LANES], any = 0.0;
#pragma omp simd reduction(+ : any)
      for (int l = 0; l < LANES; l++) {
        // volumes of tetrahedra: of both ends of the line with the triangle, of it with the edges
        const double height = of[HEIGHT][l],
                     beyond = of[0][l] * lx + of[1][l] * ly + of[2][l] * lz - height;
        const double ab = of[3][l] * lx + of[4][l] * ly + of[5][l] * lz,
                     bc = of[6][l] * lx + of[7][l] * ly + of[8][l] * lz,
                     ca = of[9][l] * lx + of[10][l] * ly + of[11][l] * lz;
        const double room = of[MARGIN][l] * length;
        const bool one = (ab > -room) & (bc > -room) & (ca > -room),
                   other = (ab < room) & (bc < room) & (ca < room);
        may[l] = (height * beyond > 0.0) & (one | other) ? 1.0 : 0.0;
        any += may[l];
      }
      if (any == 0.0) continue;
      for (int l = 0; l < LANES; l++)
        if (may[l] > 0.0) found.push_back(numbers[n + static_cast<std::size_t>(l)]);
    }
    return found;
  }

  double bytes() const
  {
    double sum = bytes_of(numbers, found);
    for (const auto &column : columns) sum += bytes_of(column);
    return sum;
  }

 private:
  // of the area and the length of a line: more than what crosses() gives an edge
  static constexpr double ROOM = 2.0 * SEAM;

  // normals of twice the area, and what the point and each edge span; volumes of the point and the
  // triangle; room for round-off per length
  static constexpr std::size_t HEIGHT = 12, MARGIN = 13, N = 14;
  std::array<AlignedVector<double>, N> columns;
  std::vector<int> numbers, found;

  void store(const std::array<Vec3, 4> &vectors, double height, double room)
  {
    std::size_t c = 0;
    for (const Vec3 &v : vectors)
      for (int d = 0; d < 3; d++) columns[c++].push_back(v[d]);
    columns[HEIGHT].push_back(height);
    columns[MARGIN].push_back(room);
  }
};

}    // namespace sphcloth

#endif
