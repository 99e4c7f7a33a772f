// SPDX-License-Identifier: GPL-2.0-or-later

#include "core/util/simd.h"

#include <boost/test/unit_test.hpp>

#include <random>
#include <vector>

using namespace sphcloth;

namespace {

std::mt19937 generator(7);

double uniform() { return std::uniform_real_distribution<>(0.0, 1.0)(generator); }

// every length, so that every tail of a vector is met; two guard entries behind the result

template <class Compact> void check_compact(const Compact &compaction)
{
  for (int n = 0; n < 70; n++) {
    std::vector<float> key(n + 32), expected(n + 32), found(n + 32);
    std::vector<int> index(n + 32), expected_index(n + 32), found_index(n + 32);
    for (int k = 0; k < n + 16; k++) {
      key[k] = static_cast<float>(uniform());
      index[k] = 100 + k;
    }
    const float limit = static_cast<float>(0.6);
    int m = 0;
    for (int k = 0; k < n; k++)
      if (key[k] < limit) {
        expected[m] = key[k];
        expected_index[m++] = index[k];
      }
    const auto agrees = [&](int count) {
      BOOST_CHECK(count == m);
      for (int k = 0; k < m; k++)
        BOOST_CHECK(found[k] == expected[k] && found_index[k] == expected_index[k]);
    };
    agrees(compaction(key.data(), index.data(), n, limit, found.data(), found_index.data()));
    // in place
    found = key;
    agrees(compaction(found.data(), index.data(), n, limit, found.data(), found_index.data()));
  }
}

// in front those below the limit, behind them the others, both in order; the rest is not touched

template <class Partition> void check_partition(const Partition &part)
{
  for (int n = 0; n < 70; n++) {
    std::vector<float> key(n + 32);
    std::vector<int> index(n + 32), spare(n + 32), kept, others;
    const float limit = static_cast<float>(0.6);
    for (int k = 0; k < n + 32; k++) {
      key[k] = static_cast<float>(uniform());
      index[k] = 100 + k;
      if (k < n) (key[k] < limit ? kept : others).push_back(index[k]);
    }
    const std::vector<float> before = key;
    const int m = part(key.data(), index.data(), n, limit, spare.data());
    kept.insert(kept.end(), others.begin(), others.end());
    BOOST_CHECK(m == n - static_cast<int>(others.size()));
    for (int k = 0; k < n + 32; k++) BOOST_CHECK(index[k] == (k < n ? kept[k] : 100 + k));
    for (int k = 0; k < m; k++) BOOST_CHECK(key[k] == before[kept[k] - 100]);
  }
}

template <class Lane, class Last> void check_columns()
{
  struct Record {
    Lane x, y, z;
    Last w;
  };
  std::vector<Record> records(40);
  for (int k = 0; k < 40; k++)
    records[k] = {static_cast<Lane>(k), static_cast<Lane>(100 + k), static_cast<Lane>(200 + k),
                  static_cast<Last>(0.25 * k)};
  constexpr int N = GROUP<Lane>;
  for (int round = 0; round < 20; round++) {
    std::vector<int> index(N);
    for (int &i : index) i = static_cast<int>(40 * uniform());
    // the columns, and two guard entries behind them
    std::vector<Lane> x(N + 2), y(N + 2), z(N + 2);
    std::vector<Last> w(N + 2);
    columns(&records[0].x, index.data(), x.data(), y.data(), z.data(), w.data());
    for (int k = 0; k < N; k++) {
      const Record &r = records[index[k]];
      BOOST_CHECK(x[k] == r.x && y[k] == r.y && z[k] == r.z && w[k] == r.w);
    }
    for (int k = N; k < N + 2; k++) BOOST_CHECK(x[k] == 0 && y[k] == 0 && z[k] == 0 && w[k] == 0);
    std::vector<Lane> x_alone(N), y_alone(N), z_alone(N);
    columns(&records[0].x, index.data(), x_alone.data(), y_alone.data(), z_alone.data(),
            static_cast<Last *>(nullptr));
    for (int k = 0; k < N; k++)
      BOOST_CHECK(x[k] == x_alone[k] && y[k] == y_alone[k] && z[k] == z_alone[k]);
  }
}

}    // namespace

BOOST_AUTO_TEST_SUITE(simd)

BOOST_AUTO_TEST_CASE(compaction_keeps_what_is_below_the_limit_in_order)
{
  check_compact([](auto... a) { return compact(a...); });
  check_compact([](auto... a) { return compact_plain(a...); });
#ifdef SPHCLOTH_X86_TARGETS
  if (HAVE_AVX2) check_compact([](auto... a) { return compact_avx2(a...); });
#endif
}

BOOST_AUTO_TEST_CASE(partition_of_a_list_in_place)
{
  check_partition([](auto... a) { return partition(a...); });
  check_partition([](auto... a) { return partition_plain(a...); });
#ifdef SPHCLOTH_X86_TARGETS
  if (HAVE_AVX2) check_partition([](auto... a) { return partition_avx2(a...); });
#endif
}

BOOST_AUTO_TEST_CASE(rows_to_columns_and_back)
{
  double numbers[4][4], column[4][4];
  for (auto &row : numbers)
    for (double &number : row) number = uniform();
  Row rows[4];
  for (int k = 0; k < 4; k++) rows[k] = *reinterpret_cast<const Row *>(numbers[k]);
  to_columns(rows, column[0], column[1], column[2], column[3]);
  for (int k = 0; k < 4; k++)
    for (int lane = 0; lane < 4; lane++) BOOST_CHECK(column[lane][k] == numbers[k][lane]);
  Row back[4];
  to_rows(column[0], column[1], column[2], back);
  for (int k = 0; k < 4; k++) {
    for (int lane = 0; lane < 3; lane++) BOOST_CHECK(back[k][lane] == numbers[k][lane]);
    BOOST_CHECK(back[k][3] == 0.0);
    take_last(back[k], rows[k]);
    for (int lane = 0; lane < 4; lane++) BOOST_CHECK(back[k][lane] == numbers[k][lane]);
  }
}

BOOST_AUTO_TEST_CASE(columns_of_records)
{
  check_columns<double, double>();
  check_columns<float, float>();
  check_columns<std::int32_t, float>();
}

BOOST_AUTO_TEST_SUITE_END()
