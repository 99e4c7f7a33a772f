// Triangulated rectangular sheets, and what follows from the triangles of any mesh: edges, hinges
// and vertex areas.

#ifndef SPHCLOTH_CORE_SHEET_H
#define SPHCLOTH_CORE_SHEET_H

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
  std::vector<Eigen::Vector2d> vertices;    // in the plane of the sheet, centred on 0
  std::vector<std::array<int, 3>> triangles;    // counter-clockwise
};

// one row of vertices: its first index and the coordinates along the row

struct SheetRow {
  int first;
  std::vector<double> u;
};

inline std::vector<SheetRow> sheet_rows(Pattern pattern, double length, double width,
                                        double spacing, Sheet &sheet)
{
  const double row_spacing = pattern == Pattern::EQUILATERAL ? std::sqrt(0.75) * spacing : spacing;
  const int columns = std::max(1, static_cast<int>(std::lround(length / spacing)));
  const int bands = std::max(1, static_cast<int>(std::lround(width / row_spacing)));
  std::vector<SheetRow> rows;
  for (int r = 0; r <= bands; r++) {
    SheetRow row{static_cast<int>(sheet.vertices.size()), {}};
    const bool staggered = pattern == Pattern::EQUILATERAL && r % 2 == 1;
    if (staggered) row.u.push_back(-0.5 * length);
    for (int c = 0; c < columns + !staggered; c++)
      row.u.push_back(length * ((c + 0.5 * staggered) / columns - 0.5));
    if (staggered) row.u.push_back(0.5 * length);
    const double v = width * (static_cast<double>(r) / bands - 0.5);
    for (double u : row.u) sheet.vertices.emplace_back(u, v);
    rows.push_back(std::move(row));
  }
  return rows;
}

// rows with the same columns: each cell is cut along one diagonal, alternating if DIAGONAL

inline void cut_cells(Pattern pattern, const SheetRow &low, const SheetRow &high, int r,
                      Sheet &sheet)
{
  for (int c = 0; c + 1 < static_cast<int>(low.u.size()); c++) {
    const int a = low.first + c, b = a + 1, d = high.first + c, e = d + 1;
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
  while (a + 1 < low.u.size() || b + 1 < high.u.size()) {
    const int at_low = low.first + static_cast<int>(a), at_high = high.first + static_cast<int>(b);
    const bool step_low = b + 1 == high.u.size() ||
        (a + 1 < low.u.size() && low.u[a + 1] + low.u[a] < high.u[b + 1] + high.u[b]);
    if (step_low) {
      sheet.triangles.push_back({at_low, at_low + 1, at_high});
      a++;
    } else {
      sheet.triangles.push_back({at_low, at_high + 1, at_high});
      b++;
    }
  }
}

// length along u, width along v; the spacing is adjusted so that whole cells fit

inline Sheet make_sheet(Pattern pattern, double length, double width, double spacing)
{
  Sheet sheet;
  const std::vector<SheetRow> rows = sheet_rows(pattern, length, width, spacing, sheet);
  for (std::size_t r = 0; r + 1 < rows.size(); r++) {
    if (pattern == Pattern::EQUILATERAL)
      zip_rows(rows[r], rows[r + 1], sheet);
    else
      cut_cells(pattern, rows[r], rows[r + 1], static_cast<int>(r), sheet);
  }
  return sheet;
}

struct MeshTopology {
  std::vector<std::array<int, 2>> edges;     // ascending
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
