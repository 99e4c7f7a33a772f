// SPDX-License-Identifier: GPL-2.0-or-later

#include "core/pbd/sheet_mesh.h"

#include <boost/test/unit_test.hpp>

#include <cmath>
#include <numeric>
#include <vector>

using namespace sphcloth;

BOOST_AUTO_TEST_SUITE(sheet_mesh)

BOOST_AUTO_TEST_CASE(each_pattern_covers_the_area_once_in_one_piece)
{
  for (Pattern pattern : {Pattern::SQUARE, Pattern::DIAGONAL, Pattern::EQUILATERAL}) {
    const Sheet sheet = make_sheet(pattern, 1.2, 0.7, 0.1);
    const std::vector<double> area = vertex_areas(sheet);
    BOOST_CHECK_SMALL(std::accumulate(area.begin(), area.end(), 0.0) - 1.2 * 0.7, 1e-12);
    for (double a : area) BOOST_CHECK(a > 0.0);
    for (const auto &t : sheet.triangles) {
      const Eigen::Vector2d e1 = sheet.vertices[t[1]] - sheet.vertices[t[0]];
      const Eigen::Vector2d e2 = sheet.vertices[t[2]] - sheet.vertices[t[0]];
      BOOST_CHECK(e1[0] * e2[1] - e1[1] * e2[0] > 0.0);
    }
    const MeshTopology mesh = mesh_topology(sheet.triangles);
    // Euler: V - E + F = 1; inner edges are hinges
    BOOST_CHECK(sheet.vertices.size() + sheet.triangles.size() == mesh.edges.size() + 1);
    BOOST_CHECK(3 * sheet.triangles.size() == mesh.edges.size() + mesh.hinges.size());
  }
}

BOOST_AUTO_TEST_CASE(corners_where_they_belong_and_edges_of_the_right_length)
{
  const Sheet sheet = make_sheet(Pattern::EQUILATERAL, 2.0, 2.0 * std::sqrt(0.75), 0.2);
  const MeshTopology mesh = mesh_topology(sheet.triangles);
  BOOST_CHECK((sheet.vertices.front() - Eigen::Vector2d(-1.0, -std::sqrt(0.75))).norm() < 1e-14);
  int full = 0;
  for (const auto &e : mesh.edges)
    full += std::fabs((sheet.vertices[e[0]] - sheet.vertices[e[1]]).norm() - 0.2) < 1e-12;
  BOOST_CHECK(full >
              static_cast<int>(mesh.edges.size()) * 9 / 10);    // the cut ones are at the border
}

BOOST_AUTO_TEST_CASE(disc_of_rings_covers_the_area_once_with_its_border_on_the_circle)
{
  for (double radius : {1.0, 1.3, 1.7, 2.2, 3.1, 5.0, 9.7, 20.0}) {
    const Sheet disc = make_disc(radius, 1.0);
    const MeshTopology mesh = mesh_topology(disc.triangles);
    const auto v = disc.vertices.size(), e = mesh.edges.size(), t = disc.triangles.size();
    const auto n = static_cast<std::size_t>(std::lround(std::sqrt(static_cast<double>(t) / 6.0)));
    const double rings = static_cast<double>(n);
    BOOST_CHECK(t == 6 * n * n && v == 1 + 3 * n * (n + 1));
    BOOST_CHECK(v + t == e + 1);
    BOOST_CHECK(3 * t == e + mesh.hinges.size());
    const std::vector<double> area = vertex_areas(disc);
    BOOST_CHECK_SMALL(std::accumulate(area.begin(), area.end(), 0.0) -
                          3.0 * rings * radius * radius * std::sin(PI / (3.0 * rings)),
                      1e-12 * radius * radius);
    for (std::size_t k = v - 6 * n; k < v; k++)
      BOOST_CHECK_SMALL(disc.vertices[k].norm() - radius, 1e-15 * radius);
    for (const auto &c : disc.triangles) {
      const Eigen::Vector2d e1 = disc.vertices[c[1]] - disc.vertices[c[0]];
      const Eigen::Vector2d e2 = disc.vertices[c[2]] - disc.vertices[c[0]];
      BOOST_CHECK(e1[0] * e2[1] - e1[1] * e2[0] > 0.0);
    }
  }
}

BOOST_AUTO_TEST_CASE(disc_has_even_edges_and_six_triangles_at_inner_vertices)
{
  for (double radius = 1.0; radius < 30.0; radius += 0.01) {
    const Sheet disc = make_disc(radius, 1.0);
    const MeshTopology mesh = mesh_topology(disc.triangles);
    bool even = true, six = true;    // checked once a disc: there are millions of edges
    for (const auto &e : mesh.edges) {
      const double length = (disc.vertices[e[0]] - disc.vertices[e[1]]).norm();
      even &= length > (radius > 10.0 ? 0.86 : 0.68) && length < (radius > 10.0 ? 1.35 : 1.41);
    }
    std::vector<int> triangles_at(disc.vertices.size(), 0);
    for (const auto &t : disc.triangles)
      for (int v : t) triangles_at[v]++;
    for (std::size_t v = 0; v < disc.vertices.size(); v++)
      six &= disc.vertices[v].norm() > 0.999 * radius ? triangles_at[v] <= 3 : triangles_at[v] == 6;
    BOOST_CHECK(even);
    BOOST_CHECK(six);
  }
}

BOOST_AUTO_TEST_SUITE_END()
