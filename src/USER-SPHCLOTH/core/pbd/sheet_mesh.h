// SPDX-License-Identifier: GPL-2.0-or-later
// Triangulated rectangles and discs, and what follows from the triangles of any mesh: edges, hinges
// and vertex areas.

#ifndef SPHCLOTH_CORE_PBD_SHEET_MESH_H
#define SPHCLOTH_CORE_PBD_SHEET_MESH_H

#include "core/sph/kernel.h"

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <utility>
#include <vector>

namespace sphcloth {

enum class Pattern { SQUARE, DIAGONAL, EQUILATERAL };

struct Sheet {
  std::vector<Eigen::Vector2d> vertices;    // in the plane of the sheet, centered on 0
  std::vector<std::array<int, 3>> triangles;    // counter-clockwise
  bool has_cells;    // triangles are halves of rectangles along the axes
};

// one row of vertices and their coordinates along the row

struct SheetRow {
  std::vector<int> vertices;
  std::vector<double> u;

  std::size_t size() const { return vertices.size(); }
};

inline int add_vertex(double u, double v, Sheet &sheet)
{
  sheet.vertices.emplace_back(u, v);
  return static_cast<int>(sheet.vertices.size()) - 1;
}

inline std::vector<SheetRow> sheet_rows(Pattern pattern, double length, double width,
                                        double spacing, Sheet &sheet)
{
  const double row_spacing = pattern == Pattern::EQUILATERAL ? std::sqrt(0.75) * spacing : spacing;
  const int columns = std::max(1, static_cast<int>(std::lround(length / spacing)));
  const int bands = std::max(1, static_cast<int>(std::lround(width / row_spacing)));
  std::vector<SheetRow> rows;
  for (int r = 0; r <= bands; r++) {
    SheetRow row;
    const bool staggered = pattern == Pattern::EQUILATERAL && r % 2 == 1;
    if (staggered) row.u.push_back(-0.5 * length);
    for (int c = 0; c < columns + !staggered; c++)
      row.u.push_back(length * ((c + 0.5 * staggered) / columns - 0.5));
    if (staggered) row.u.push_back(0.5 * length);
    const double v = width * (static_cast<double>(r) / bands - 0.5);
    for (double u : row.u) row.vertices.push_back(add_vertex(u, v, sheet));
    rows.push_back(std::move(row));
  }
  return rows;
}

// rows with the same columns: each cell is cut along one diagonal, alternating if DIAGONAL

inline void cut_cells(Pattern pattern, const SheetRow &low, const SheetRow &high, std::size_t r,
                      Sheet &sheet)
{
  for (std::size_t c = 0; c + 1 < low.size(); c++) {
    const int a = low.vertices[c], b = low.vertices[c + 1];
    const int d = high.vertices[c], e = high.vertices[c + 1];
    if (pattern == Pattern::DIAGONAL && (r + c) % 2 == 1) {
      sheet.triangles.push_back({a, b, d});
      sheet.triangles.push_back({b, e, d});
    } else {
      sheet.triangles.push_back({a, b, e});
      sheet.triangles.push_back({a, e, d});
    }
  }
}

// rows with different columns: always step on in the row that is behind

inline void zip_rows(const SheetRow &low, const SheetRow &high, Sheet &sheet)
{
  std::size_t a = 0, b = 0;
  while (a + 1 < low.size() || b + 1 < high.size()) {
    const int at_low = low.vertices[a], at_high = high.vertices[b];
    const bool step_low = b + 1 == high.size() ||
        (a + 1 < low.size() && low.u[a + 1] + low.u[a] < high.u[b + 1] + high.u[b]);
    sheet.triangles.push_back({at_low, step_low ? low.vertices[++a] : high.vertices[++b], at_high});
  }
}

// length along u, width along v; the spacing is adjusted so that whole cells fit

inline Sheet make_sheet(Pattern pattern, double length, double width, double spacing)
{
  Sheet sheet{{}, {}, pattern != Pattern::EQUILATERAL};
  const std::vector<SheetRow> rows = sheet_rows(pattern, length, width, spacing, sheet);
  for (std::size_t r = 0; r + 1 < rows.size(); r++) {
    if (pattern == Pattern::EQUILATERAL)
      zip_rows(rows[r], rows[r + 1], sheet);
    else
      cut_cells(pattern, rows[r], rows[r + 1], r, sheet);
  }
  return sheet;
}

// ring k of a disc: 6 k vertices, the coordinate is the part of a turn, and the last is the first

inline SheetRow disc_ring(int k, double radius, Sheet &sheet)
{
  SheetRow ring;
  for (int m = 0; m < 6 * k; m++) {
    const double turn = m / (6.0 * k), angle = 2.0 * PI * turn;
    ring.vertices.push_back(add_vertex(radius * std::cos(angle), radius * std::sin(angle), sheet));
    ring.u.push_back(turn);
  }
  ring.vertices.push_back(ring.vertices.front());
  ring.u.push_back(1.0);
  return ring;
}

// Rings around a vertex in the center: a hexagon of equilateral triangles, bent until its border is
// a circle.  With the distance h of rings, edges are h to sqrt(1 + (pi/3)^2) h long.

inline Sheet make_disc(double radius, double spacing)
{
  // so far apart, rings have as many vertices per area as equilateral triangles
  const double distance = std::sqrt(1.5 * std::sqrt(3.0) / PI) * spacing;
  const int rings = std::max(1, static_cast<int>(std::lround(radius / distance)));
  Sheet disc{{}, {}, false};
  SheetRow inner{{add_vertex(0.0, 0.0, disc)}, {0.0}};
  for (int k = 1; k <= rings; k++) {
    SheetRow outer = disc_ring(k, radius * k / rings, disc);
    zip_rows(outer, inner, disc);
    inner = std::move(outer);
  }
  return disc;
}

inline bool is_diagonal_of_cell(const Sheet &sheet, const std::array<int, 2> &edge)
{
  const Eigen::Vector2d d = sheet.vertices[edge[1]] - sheet.vertices[edge[0]];
  return sheet.has_cells && d.cwiseAbs().minCoeff() > 1e-6 * d.norm();
}

struct MeshTopology {
  std::vector<std::array<int, 2>> edges;    // ascending
  std::vector<std::array<int, 4>> hinges;    // wing, edge, edge, wing; edges of two triangles
};

inline MeshTopology mesh_topology(const std::vector<std::array<int, 3>> &triangles)
{
  std::map<std::array<int, 2>, std::vector<int>> wings;    // opposite vertices of each edge
  for (const auto &t : triangles)
    for (int k = 0; k < 3; k++) {
      const int a = t[k], b = t[(k + 1) % 3];
      wings[{std::min(a, b), std::max(a, b)}].push_back(t[(k + 2) % 3]);
    }
  MeshTopology mesh;
  for (const auto &[edge, opposite] : wings) {
    mesh.edges.push_back(edge);
    if (opposite.size() == 2) mesh.hinges.push_back({opposite[0], edge[0], edge[1], opposite[1]});
  }
  return mesh;
}

// a third of the area of the triangles around each vertex

inline std::vector<double> vertex_areas(const Sheet &sheet)
{
  std::vector<double> area(sheet.vertices.size(), 0.0);
  for (const auto &t : sheet.triangles) {
    const Eigen::Vector2d e1 = sheet.vertices[t[1]] - sheet.vertices[t[0]];
    const Eigen::Vector2d e2 = sheet.vertices[t[2]] - sheet.vertices[t[0]];
    const double third = std::fabs(e1[0] * e2[1] - e1[1] * e2[0]) / 6.0;
    for (int v : t) area[v] += third;
  }
  return area;
}

}    // namespace sphcloth

#endif
