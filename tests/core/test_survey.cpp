#include "check.h"
#include "core/neighbor/block_minmax.h"

#include <random>

using namespace sphcloth;

namespace {

constexpr double WIDTH = 0.1;
constexpr int TYPES = 2;

struct Scattered {
  std::vector<double> x;
  std::vector<int> type, value;
  Blocks blocks;
  int n;

  explicit Scattered(int n_) : n(n_)
  {
    std::mt19937 generator{5};
    std::uniform_real_distribution<> u(0.0, 1.0);
    for (int i = 0; i < 3 * n; i++) x.push_back(u(generator));
    for (int i = 0; i < n; i++) type.push_back(1 + i % TYPES);
    blocks.divide(x.data(), type.data(), n, TYPES, WIDTH);
  }
  bool near(int i, int j) const
  {
    double r_sq = 0.0;
    for (int d = 0; d < 3; d++) r_sq += std::pow(x[3 * i + d] - x[3 * j + d], 2);
    return r_sq < WIDTH * WIDTH;
  }
  int block(int i) const { return blocks.of_particle()[i]; }
};

}    // namespace

CASE("blocks: each particle is in one, by its type, and many are in each")
{
  const Scattered s(9000);
  CHECK(s.blocks.count() > 100);
  CHECK(s.n >= 32 * (s.blocks.count() - 1));
  std::vector<int> found(s.n);
  for (int b = 0; b < s.blocks.count(); b++)
    for (int t = 1; t <= TYPES; t++)
      for (const int i : s.blocks.in(s.blocks.row(b, t))) {
        found[i]++;
        CHECK(s.type[i] == t);
        CHECK(s.block(i) == b);
      }
  for (const int times : found) CHECK(times == 1);
}

CASE("a survey tells what neighbours have, whatever their block")
{
  Scattered s(9000);
  s.value.assign(s.n, 3);
  Survey survey(s.blocks);
  survey.take(s.value.data());
  for (int b = 0; b < s.blocks.count(); b++)
    for (int t = 1; t <= TYPES; t++) CHECK(survey.all_have(3, b, t) && survey.greatest(b, t) == 3);

  // two others, of one type
  const int low = 100, high = 200;
  s.value[low] = 1;
  s.value[high] = 7;
  survey.take(s.value.data());
  int beside = 0, quiet = 0;
  for (int i = 0; i < s.n; i++) {
    const int b = s.block(i), t = s.type[low];
    if (s.near(i, low) || s.near(i, high)) {
      beside++;
      CHECK(!survey.all_have(3, b, t));
      if (s.near(i, high)) CHECK(survey.greatest(b, t) == 7);
    }
    CHECK(!survey.all_have(1, b, t));
    CHECK(survey.all_have(3, b, 3 - t));    // of the other type nobody has changed
    quiet += survey.all_have(3, b, t);
  }
  CHECK(beside > 20);
  CHECK(quiet > s.n / 2);
}

CASE("a survey of nobody finds nothing")
{
  const std::vector<double> x{0.5, 0.5, 0.5};
  const std::vector<int> type{1}, value{4};
  Blocks blocks;
  blocks.divide(x.data(), type.data(), 1, TYPES, WIDTH);
  Survey survey(blocks);
  survey.take(value.data());
  CHECK(survey.all_have(4, 0, 1) && !survey.all_have(5, 0, 1));
  CHECK(survey.all_have(5, 0, 2));
  CHECK(survey.greatest(0, 2) < -1000000);
}
