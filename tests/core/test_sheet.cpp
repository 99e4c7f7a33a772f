#include "check.h"
#include "core/pbd/coloring.h"
#include "core/pbd/sheet_mesh.h"

#include <numeric>
#include <set>

using namespace sphcloth;

CASE("sheet: every pattern covers the area once, is one piece and a disc")
{
  for (Pattern pattern : {Pattern::SQUARE, Pattern::DIAGONAL, Pattern::EQUILATERAL}) {
    const Sheet sheet = make_sheet(pattern, 1.2, 0.7, 0.1);
    const std::vector<double> area = vertex_areas(sheet);
    CHECK_NEAR(std::accumulate(area.begin(), area.end(), 0.0), 1.2 * 0.7, 1e-12);
    for (double a : area) CHECK(a > 0.0);
    for (const auto &t : sheet.triangles) {
      const Eigen::Vector2d e1 = sheet.vertices[t[1]] - sheet.vertices[t[0]];
      const Eigen::Vector2d e2 = sheet.vertices[t[2]] - sheet.vertices[t[0]];
      CHECK(e1[0] * e2[1] - e1[1] * e2[0] > 0.0);
    }
    const MeshTopology mesh = mesh_topology(sheet.triangles);
    // Euler: V - E + F = 1; inner edges are hinges
    CHECK(sheet.vertices.size() + sheet.triangles.size() == mesh.edges.size() + 1);
    CHECK(3 * sheet.triangles.size() == mesh.edges.size() + mesh.hinges.size());
  }
}

CASE("sheet: corners where they belong, edges of the right length")
{
  const Sheet sheet = make_sheet(Pattern::EQUILATERAL, 2.0, 2.0 * std::sqrt(0.75), 0.2);
  const MeshTopology mesh = mesh_topology(sheet.triangles);
  CHECK((sheet.vertices.front() - Eigen::Vector2d(-1.0, -std::sqrt(0.75))).norm() < 1e-14);
  int full = 0;
  for (const auto &e : mesh.edges)
    full += std::fabs((sheet.vertices[e[0]] - sheet.vertices[e[1]]).norm() - 0.2) < 1e-12;
  CHECK(full > static_cast<int>(mesh.edges.size()) * 9 / 10);    // the cut ones are at the border
}

CASE("disc: counts of rings, an area once, the border on the circle, every inner edge a hinge")
{
  for (double radius : {1.0, 1.3, 1.7, 2.2, 3.1, 5.0, 9.7, 20.0}) {
    const Sheet disc = make_disc(radius, 1.0);
    const MeshTopology mesh = mesh_topology(disc.triangles);
    const auto v = disc.vertices.size(), e = mesh.edges.size(), t = disc.triangles.size();
    const auto n = static_cast<std::size_t>(std::lround(std::sqrt(static_cast<double>(t) / 6.0)));
    const double rings = static_cast<double>(n);
    CHECK(t == 6 * n * n && v == 1 + 3 * n * (n + 1));
    CHECK(v + t == e + 1);
    CHECK(3 * t == e + mesh.hinges.size());
    const std::vector<double> area = vertex_areas(disc);
    CHECK_NEAR(std::accumulate(area.begin(), area.end(), 0.0),
               3.0 * rings * radius * radius * std::sin(PI / (3.0 * rings)),
               1e-12 * radius * radius);
    for (std::size_t k = v - 6 * n; k < v; k++)
      CHECK_NEAR(disc.vertices[k].norm(), radius, 1e-15 * radius);
    for (const auto &c : disc.triangles) {
      const Eigen::Vector2d e1 = disc.vertices[c[1]] - disc.vertices[c[0]];
      const Eigen::Vector2d e2 = disc.vertices[c[2]] - disc.vertices[c[0]];
      CHECK(e1[0] * e2[1] - e1[1] * e2[0] > 0.0);
    }
  }
}

CASE("disc: edges of 0.68 to 1.41 of the spacing, six triangles at every inner vertex")
{
  for (double radius = 1.0; radius < 30.0; radius += 0.01) {
    const Sheet disc = make_disc(radius, 1.0);
    const MeshTopology mesh = mesh_topology(disc.triangles);
    for (const auto &e : mesh.edges) {
      const double length = (disc.vertices[e[0]] - disc.vertices[e[1]]).norm();
      CHECK(length > (radius > 10.0 ? 0.86 : 0.68) && length < (radius > 10.0 ? 1.35 : 1.41));
    }
    std::vector<int> triangles_at(disc.vertices.size(), 0);
    for (const auto &t : disc.triangles)
      for (int v : t) triangles_at[v]++;
    for (std::size_t v = 0; v < disc.vertices.size(); v++)
      CHECK(disc.vertices[v].norm() > 0.999 * radius ? triangles_at[v] <= 3 : triangles_at[v] == 6);
  }
}

CASE("colours: no two constraints of one colour share a vertex")
{
  const Sheet sheet = make_sheet(Pattern::DIAGONAL, 1.0, 1.0, 0.05);
  const MeshTopology mesh = mesh_topology(sheet.triangles);
  int n = 0;
  const auto colour = colour_constraints(mesh.hinges, static_cast<int>(sheet.vertices.size()), n);
  std::set<std::pair<int, int>> seen;
  for (std::size_t m = 0; m < mesh.hinges.size(); m++)
    for (int v : mesh.hinges[m]) CHECK(seen.insert({colour[m], v}).second);
  CHECK(n > 0 && n < 40);
}
