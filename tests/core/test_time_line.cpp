#include "check.h"
#include "core/timestep/time_bins.h"

using namespace sphcloth;

CASE("time line: steps begin at multiples of their length")
{
  TimeLine line{1.0, 0};
  CHECK(line.coarsest() == 0);
  line.now = TimeLine::ticks(3);
  CHECK(line.coarsest() == 3);
  CHECK(line.begins(3) && line.begins(4) && !line.begins(2));
  line.now += TimeLine::ticks(3);
  CHECK(line.coarsest() == 2);
  line.now = TimeLine::ticks(0);
  CHECK(line.ended() && line.coarsest() == 0);
}

CASE("time line: the longest step that is not above what is wanted")
{
  const TimeLine line{1.0, 0};
  CHECK(line.level_of(2.0) == 0 && line.level_of(1.0) == 0);
  CHECK(line.level_of(0.99) == 1 && line.level_of(0.5) == 1 && line.level_of(0.3) == 2);
  CHECK(line.level_of(0.5 * (1.0 - 1e-14)) == 1);    // rounding
  for (double dt = 1.0; dt > 1e-6; dt *= 0.77) {
    const double taken = line.step(line.level_of(dt));
    CHECK(taken <= dt * (1.0 + 1e-12) && taken > 0.5 * dt);
  }
}

// updates per time when every wanted step is rounded down to root / 2^k

static double cost(const std::vector<double> &wanted, double root)
{
  double sum = 0.0;
  const TimeLine line{root, 0};
  for (const double dt : wanted) sum += 1.0 / line.step(line.level_of(dt));
  return sum;
}

CASE("wanted steps: one for all is taken as it is, two populations each nearly so")
{
  WantedSteps one;
  for (int k = 0; k < 100; k++) one.add(0.3, 0.3);
  CHECK_NEAR(one.best_root(0.3, 0.1, 1.0), 0.3, 1e-15);

  // few with 0.3, many with 1.1: steps of 0.3 and 0.6 waste, 0.275 and 1.1 do not
  std::vector<double> wanted(10, 0.3);
  wanted.resize(1000, 1.1);
  WantedSteps two;
  for (const double dt : wanted) two.add(dt, 0.3);
  const double root = two.best_root(0.3, 0.0, 1.0);
  double ideal = 0.0;
  for (const double dt : wanted) ideal += 1.0 / dt;
  CHECK(cost(wanted, root) < 1.05 * ideal);
  CHECK(cost(wanted, 4.0 * 0.3) > 1.5 * ideal);
  CHECK(root <= 1.1 && root > 1.05);
}

CASE("wanted steps: nobody gets more than wanted, whatever the root")
{
  std::vector<double> wanted;
  for (int k = 0; k < 300; k++) wanted.push_back(1e-4 * std::pow(1.03, k % 170));
  WantedSteps all;
  for (const double dt : wanted) all.add(dt, 1e-4);
  const TimeLine line{all.best_root(1e-4, 0.1, 1.0), 0};
  CHECK(line.root > 5e-5);
  for (const double dt : wanted) CHECK(line.step(line.level_of(dt)) <= dt * (1.0 + 1e-12));
}

CASE("wanted steps: equal roots arrive at an output time, and cost little more")
{
  // as above: steps of 0.275 and 1.1 are best
  std::vector<double> wanted(10, 0.3);
  wanted.resize(1000, 1.1);
  WantedSteps two;
  for (const double dt : wanted) two.add(dt, 0.3);
  const double best = two.best_root(0.3, 0.0, 1.0), best_cost = cost(wanted, best);
  for (double remaining = 1.2; remaining < 17.0; remaining += 0.37) {
    const double root = two.root_towards(remaining, 0.3, 0.0, 1.0), roots = remaining / root;
    CHECK_NEAR(roots, std::round(roots), 1e-12);
    CHECK(root <= 1.1);
    const double shortened = std::ceil(remaining / best) * best / remaining;
    CHECK(cost(wanted, root) < 1.01 * shortened * best_cost);
  }
  CHECK_NEAR(two.root_towards(0.9, 0.3, 0.0, 1.0), 0.9, 0.0);
  CHECK_NEAR(two.root_towards(100.0, 0.3, 0.0, 1.0), two.best_root(0.3, 0.0, 1.0), 0.0);

  WantedSteps one;
  for (int k = 0; k < 100; k++) one.add(0.3, 0.3);
  CHECK_NEAR(one.root_towards(0.5, 0.3, 0.0, 1.0), 0.25, 1e-15);
  CHECK_NEAR(one.root_towards(0.7, 0.3, 0.0, 1.0), 0.3, 1e-15);
}

CASE("wanted steps: one for all unless unequal ones gain enough")
{
  // 1000 / 0.3 updates per time with one step for all, 10 / 0.275 + 990 / 1.1 with two: 3.56 times fewer
  WantedSteps two;
  for (int k = 0; k < 1000; k++) two.add(k < 10 ? 0.3 : 1.1, 0.3);
  CHECK(two.best_root(0.3, 0.0, 3.4) > 1.0);
  CHECK_NEAR(two.best_root(0.3, 0.0, 3.7), 0.3, 0.0);
  CHECK_NEAR(two.root_towards(0.5, 0.3, 0.0, 3.7), 0.25, 1e-15);
  // what each step costs besides makes it 2.8
  CHECK(two.best_root(0.3, 0.1, 2.7) > 1.0);
  CHECK_NEAR(two.best_root(0.3, 0.1, 2.9), 0.3, 0.0);
}
