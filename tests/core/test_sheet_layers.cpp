// SPDX-License-Identifier: GPL-2.0-or-later

#include "core/contact/sheet_layers.h"

#include <boost/test/unit_test.hpp>

#include <random>
#include <vector>

using namespace sphcloth;

BOOST_AUTO_TEST_SUITE(sheet_layers)

namespace {

using Triangle = SheetLayers::Triangle;

// a square at a height, of two triangles

void add_square(std::vector<Triangle> &to, double z, bool upwards = true)
{
  const Vec3 a(0, 0, z), b(1, 0, z), c(1, 1, z), d(0, 1, z);
  if (upwards)
    to.insert(to.end(), {{a, b, c}, {a, c, d}});
  else
    to.insert(to.end(), {{a, c, b}, {a, d, c}});
}

// the sides of points, as of their nearest triangle

struct Scene {
  std::vector<Triangle> triangles;
  std::vector<double> x;
  std::vector<Sides> sides;
  SheetLayers layers;

  Scene(const std::vector<Triangle> &of, const std::vector<Vec3> &points, Sides more = NEAR_SHEET,
        double distance = 1.0) : triangles(of)
  {
    layers.start(points.size(), distance);
    for (std::size_t i = 0; i < points.size(); i++) {
      double nearest = 1e30;
      sides.push_back(0);
      for (const auto &[a, b, c] : triangles) {
        Vec3 weight;
        const Vec3 out = distance_vector(points[i], a, b, c, weight);
        if (out.norm() >= nearest || out.norm() > distance) continue;
        nearest = out.norm();
        layers.set_nearest(static_cast<int>(i), -out);
        sides[i] = more | side_of_sheet(0, (b - a).cross(c - a).dot(out) > 0.0);
      }
      x.insert(x.end(), points[i].data(), points[i].data() + 3);
    }
    for (const Triangle &t : triangles) layers.add(t);
    layers.finish(x.data(), static_cast<int>(points.size()));
  }
  bool part(int i, int j)
  {
    return are_doubtful(sides[i], sides[j]) && layers.part(i, j, sides[i], sides[j]);
  }
};

}    // namespace

BOOST_AUTO_TEST_CASE(a_line_crosses_a_triangle_or_its_edge)
{
  const Vec3 a(0, 0, 0), b(1, 0, 0), c(0, 1, 0), up(0.2, 0.3, 0.5), down(0.2, 0.3, -0.25);
  BOOST_CHECK(crosses(up, down, a, b, c) && crosses(down, up, a, c, b));
  BOOST_CHECK(!crosses(up, Vec3(0.2, 0.3, 0.1), a, b, c));
  BOOST_CHECK(!crosses(Vec3(2, 2, 1), Vec3(2, 2, -1), a, b, c));
  BOOST_CHECK(!crosses(Vec3(0.1, 0.1, 1e-17), Vec3(0.5, 0.2, -1e-17), a, b, c));    // in its plane
  BOOST_CHECK(!crosses(Vec3(0.2, 0.2, 0), Vec3(0.2, 0.2, -1), a, b, c));    // ends on it
  for (const Vec3 &on : {Vec3(0.3, 0.7, 0), Vec3(0.3, 0, 0), a, b})
    BOOST_CHECK(crosses(on + Vec3(0.1, 0.2, 0.4), on - Vec3(0.1, 0.2, 0.4), a, b, c));
}

BOOST_AUTO_TEST_CASE(no_line_slips_through_between_neighbors)
{
  std::mt19937 random(3);
  std::uniform_real_distribution<double> any(-1.0, 1.0);
  for (int n = 0; n < 20000; n++) {
    const Vec3 center(0.1 * any(random), 0.1 * any(random), 0.1 * any(random));
    std::vector<Vec3> rim;
    for (int k = 0; k < 6; k++)
      rim.emplace_back(std::cos(k * M_PI / 3) + 0.2 * any(random),
                       std::sin(k * M_PI / 3) + 0.2 * any(random), 0.3 * any(random));
    // through the vertex in the middle, or a point of one of its edges
    const Vec3 on = n % 2 ? center : Vec3(center + std::fabs(any(random)) * (rim[n % 6] - center));
    const Vec3 line(0.4 * any(random), 0.4 * any(random), 1.5);
    const double before = 0.5 + 0.4 * any(random);
    bool crossed = false, back = false;
    for (int k = 0; k < 6; k++) {
      const Vec3 &next = rim[(k + 1) % 6];
      crossed = crossed || crosses(on - before * line, on + line, center, rim[k], next);
      back = back || crosses(on + line, on - before * line, center, rim[k], next);
    }
    BOOST_REQUIRE(crossed && back);
  }
}

BOOST_AUTO_TEST_CASE(what_is_bent_by_more_than_a_right_angle_or_lies_beside_is_another_layer)
{
  const Vec3 foot(0, 0, 0), up(0, 0, 1);
  const auto is_other = [&](const Triangle &t) { return is_another_layer(foot, up, t, 1e-3); };
  const auto bent_by = [](double degrees) {    // at an edge beside the foot
    const double angle = degrees * M_PI / 180.0;
    const Vec3 b(0.1, 0, 0), along(std::cos(angle), 0, std::sin(angle));
    return Triangle{b + Vec3(0, -1, 0), b + along, b + Vec3(0, 1, 0)};
  };
  BOOST_CHECK(!is_other(bent_by(0)) && !is_other(bent_by(90)));
  BOOST_CHECK(is_other(bent_by(93)) && is_other(bent_by(180)));
  const auto arc_of = [](double degrees) {    // a tangent of an arc, as far on it
    const double angle = degrees * M_PI / 180.0;
    const Vec3 at(std::sin(angle), 0, 1 - std::cos(angle));
    const Vec3 along = 0.01 * Vec3(std::cos(angle), 0, std::sin(angle)), beside(0, 0.01, 0);
    return Triangle{at - beside, at + along, at + beside};
  };
  BOOST_CHECK(!is_other(arc_of(88)) && is_other(arc_of(94)));
  std::vector<Triangle> above;
  add_square(above, 0.1);
  BOOST_CHECK(is_another_layer(Vec3(0.7, 0.2, 0), up, above[0], 1e-3));
  BOOST_CHECK(!is_another_layer(Vec3(0.7, 0.2, 0), up, above[0], 0.11));    // no room
  BOOST_CHECK(!is_another_layer(Vec3(-0.5, 0.2, 0), up, above[0], 1e-3));    // far aside
}

BOOST_AUTO_TEST_CASE(the_quick_test_misses_no_layer)
{
  std::mt19937 random(4);
  std::uniform_real_distribution<double> any(-1.0, 1.0);
  const auto point = [&] { return Vec3(any(random), any(random), any(random)); };
  int layers = 0, quick = 0;
  for (int n = 0; n < 5000; n++) {
    const Vec3 center = point(), a = 0.3 * point(), b = 0.3 * point();
    const Triangle t{center, center + a, center + b};
    DiscGrid grid;
    grid.build({disc_around(t[0], t[1], t[2])}, 1.0);
    const Vec3 p = 0.3 * point(), foot = p + 0.1 * point(), normal = Vec3(0, 0.1, 1).normalized();
    bool within = false;
    const bool may = !may_be_other_layers(grid, p, 1.0, foot, normal, 0.05).empty();
    grid.within(p, 1.0, [&](int) { within = true; });
    quick += may;
    if (!within || !is_another_layer(foot, normal, t, 0.05)) continue;
    layers++;
    BOOST_REQUIRE(may);
  }
  BOOST_CHECK(layers > 1000 && quick < 4000);
}

BOOST_AUTO_TEST_CASE(sides_decide_beside_one_layer)
{
  std::vector<Triangle> flat;
  add_square(flat, 0.0);
  // the last two: above and below, with a line beside the sheet
  Scene scene(flat, {{0.5, 0.5, 0.1}, {0.5, 0.4, -0.1}, {0.4, 0.5, 0.2}});
  BOOST_CHECK(scene.part(0, 1) && scene.part(1, 0) && !scene.part(0, 2) && scene.part(2, 1));
  scene.sides[0] = NEAR_SHEET;    // as beyond the border
  BOOST_CHECK(!scene.part(0, 1));
}

BOOST_AUTO_TEST_CASE(layers_part_what_is_beyond_them)
{
  for (const bool upwards : {false, true}) {    // as of a fold, or of two pieces
    std::vector<Triangle> two;
    add_square(two, 0.0);
    add_square(two, 0.2, upwards);
    const std::vector<Vec3> points{{0.5, 0.5, -0.1}, {0.5, 0.5, 0.05}, {0.5, 0.5, 0.15},
                                   {0.5, 0.5, 0.3},  {0.2, 0.3, -0.1}, {1.5, 0.5, 0.1}};
    const int pool[] = {0, 1, 1, 2, 0};
    for (const Sides flag : {NEAR_SHEET, NEAR_SHEET | LAYERED}) {
      Scene scene(two, points, NEAR_SHEET | flag);
      for (int i = 0; i < 5; i++)
        for (int j = 0; j < 5; j++)
          // what is not marked is parted by its sides alone
          if (i != j && (flag & LAYERED || (pool[i] == 1 && pool[j] == 1)))
            BOOST_CHECK_EQUAL(scene.part(i, j), pool[i] != pool[j]);
      if (flag & LAYERED) BOOST_CHECK(!scene.part(2, 5) && !scene.part(5, 2));
    }
  }
}

BOOST_AUTO_TEST_CASE(one_that_sees_more_than_one_layer_is_enough)
{
  std::vector<Triangle> two;
  add_square(two, 0.0);
  add_square(two, 0.4);
  // below the middle, but above the lower one as those over both are
  Scene scene(two, {{0.5, 0.5, 0.15}, {0.5, 0.5, 0.6}});
  BOOST_CHECK(!scene.part(0, 1));
  scene.sides[0] |= LAYERED;
  BOOST_CHECK(scene.part(0, 1) && scene.part(1, 0));
}

BOOST_AUTO_TEST_CASE(nothing_moves_until_the_next_start)
{
  std::vector<Triangle> flat;
  add_square(flat, 0.0);
  Scene scene(flat, {{0.5, 0.5, 0.1}, {0.5, 0.4, -0.1}}, NEAR_SHEET | LAYERED);
  scene.x[2] = -0.2;
  BOOST_CHECK(scene.part(0, 1));
  BOOST_CHECK(scene.layers.any() && scene.layers.bytes() > 0.0);
  scene.layers.start(2, 1.0);
  BOOST_CHECK(!scene.layers.any());
}

BOOST_AUTO_TEST_SUITE_END()
