// SPDX-License-Identifier: GPL-2.0-or-later

#include "core/pores/pore_law.h"

#include <boost/test/unit_test.hpp>

#include <cmath>

using namespace sphcloth;

BOOST_AUTO_TEST_SUITE(pore_law)

BOOST_AUTO_TEST_CASE(shares_of_rows_add_up_to_one)
{
  for (const int rows : {2, 4, 6})    // in the layer
    for (const double shift : {0.0, 0.1, 0.37, 0.5, 0.93}) {
      const double spacing = 0.25, width = rows * spacing;
      double sum = 0.0;
      for (int k = -1; k <= rows; k++)
        sum += spacing * share_in_layer((k + shift) * spacing, width);
      BOOST_CHECK_SMALL(sum - 1.0, 1e-14);
    }
  BOOST_TEST(share_in_layer(0.0, 1.0) == 0.0);
  BOOST_TEST(share_in_layer(-0.1, 1.0) == 0.0);
  BOOST_TEST(share_in_layer(1.0, 1.0) == 0.0);
}

BOOST_AUTO_TEST_CASE(the_layer_that_water_comes_from_takes_the_pressure)
{
  double flow = 0.0;
  for (int n = 0; n < 5; n++) flow = next_flow(flow, -0.05, 1.0);
  BOOST_TEST(flow == -1.0);    // downward
  const PartOfLayers both = part_of_layers(flow, 1.0, 1.0);
  BOOST_TEST(both.above == 1.0);
  BOOST_TEST(both.below == 0.0);
  // to and fro by less than an eighth of the width it stays there
  for (int n = 0; n < 20; n++) flow = next_flow(flow, n % 2 ? -0.02 : 0.02, 1.0);
  BOOST_TEST(flow < -0.8);
  for (const double of : {-1.0, -0.4, 0.0, 0.7, 1.0})
    for (const double full : {0.0, 0.3, 1.0}) {
      const PartOfLayers part = part_of_layers(of, 1.0, full);
      const double sum = part.above + full * part.below;
      BOOST_TEST(sum <= 1.0 + 1e-14);
      // of a full layer and another one all is taken, but for water that comes from the other
      if (of <= 0.0) BOOST_CHECK_SMALL(sum - 1.0, 1e-14);
    }
  BOOST_TEST(part_of_layers(1.0, 1.0, 0.0).above == 0.0);    // no 0/0
  // a spray is slowed by what it fills
  const PartOfLayers spray = part_of_layers(-1.0, 0.1, 0.0);
  BOOST_TEST(spray.above == 1.0);
}

BOOST_AUTO_TEST_CASE(the_speed_of_the_end_balances_the_drag)
{
  for (const double linear : {0.0, 1e-9, 0.3, 1e6})
    for (const double quadratic : {0.0, 1e-12, 0.7, 1e8}) {
      const double u = slowed(2.0, linear, quadratic);
      BOOST_TEST(u > 0.0);
      BOOST_TEST(u <= 2.0);
      BOOST_CHECK_SMALL((u + linear * u + quadratic * u * u) / 2.0 - 1.0, 1e-12);
    }
  BOOST_TEST(slowed(0.0, 0.0, 0.0) == 0.0);
  BOOST_TEST(slowed(-2.0, 0.3, 0.7) == -slowed(2.0, 0.3, 0.7));
}

// C_D of a cylinder: 1.0 at a Reynolds number of 1000, 1.1 to 1.2 at 10,000 (Goldstein's curve)

BOOST_AUTO_TEST_CASE(a_cylinder_has_the_drag_that_was_measured)
{
  BOOST_TEST(std::fabs(Screen::of_cylinder(3.0) - 0.98) < 0.05);
  BOOST_TEST(std::fabs(Screen::of_cylinder(4.0) - 1.12) < 0.06);
  BOOST_TEST(std::fabs(Screen::of_cylinder(2.0) - 1.5) < 0.2);
  BOOST_TEST(Screen::of_cylinder(0.0) == Screen::of_cylinder(1.5));
}

// Taylor: with the velocity u = U / (1 + k/4) in it, rho/2 k u^2 is C_0 rho/2 U^2

BOOST_AUTO_TEST_CASE(a_net_across_the_flow_has_the_drag_coefficient_of_the_model)
{
  const Screen net(0.2, 2e-3, 1e-6);
  const double free = 0.5, c = net.drag_coefficient(free), k = Screen::loss(c);
  BOOST_CHECK_SMALL(k / std::pow(1.0 + 0.25 * k, 2) - c, 1e-14);
  const double in_net = free / (1.0 + 0.25 * k);
  const PoreDrag drag = net.drag(in_net, 0.0, 1000.0);
  BOOST_CHECK_SMALL(drag.across * in_net / (0.5 * 1000.0 * c * free * free) - 1.0, 1e-6);
  BOOST_TEST(net.drag(0.0, 0.0, 1000.0).across == 0.0);
}

BOOST_AUTO_TEST_CASE(a_net_along_the_flow_has_no_pressure_but_some_drag)
{
  const Screen net(0.2, 2e-3, 1e-6);
  const double across = net.drag(1.0, 0.0, 1000.0).across;
  const PoreDrag oblique = net.drag(std::sqrt(0.5), std::sqrt(0.5), 1000.0);
  BOOST_TEST(oblique.along > 0.0);
  BOOST_TEST(oblique.along < oblique.across);
  BOOST_TEST(oblique.across < 1.5 * across);
}

BOOST_AUTO_TEST_SUITE_END()
