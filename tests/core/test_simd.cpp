#include "check.h"
#include "core/simd.h"

#include <random>

using namespace sphcloth;

namespace {

std::mt19937 generator(7);

double uniform() { return std::uniform_real_distribution<>(0.0, 1.0)(generator); }

// every length, so that every tail of a vector is met; two guard entries behind the result

template <class Key> void check_compact()
{
  for (int n = 0; n < 70; n++) {
    std::vector<Key> key(n + 32), expected(n + 32), found(n + 32);
    std::vector<int> index(n + 32), expected_index(n + 32), found_index(n + 32);
    for (int k = 0; k < n + 16; k++) {
      key[k] = static_cast<Key>(uniform());
      index[k] = 100 + k;
    }
    const Key limit = static_cast<Key>(0.6);
    int m = 0;
    for (int k = 0; k < n; k++)
      if (key[k] < limit) {
        expected[m] = key[k];
        expected_index[m++] = index[k];
      }
    const auto agrees = [&](int count) {
      CHECK(count == m);
      for (int k = 0; k < m; k++)
        CHECK(found[k] == expected[k] && found_index[k] == expected_index[k]);
    };
    agrees(compact_plain(key.data(), index.data(), n, limit, found.data(), found_index.data()));
    agrees(compact(key.data(), index.data(), n, limit, found.data(), found_index.data()));
    // in place
    found = key;
    agrees(compact(found.data(), index.data(), n, limit, found.data(), found_index.data()));
  }
}

// in front those below the limit, behind them the others, both in order; the rest is not touched

template <class Key, class Partition> void check_partition(const Partition &part)
{
  for (int n = 0; n < 70; n++) {
    std::vector<Key> key(n + 32);
    std::vector<int> index(n + 32), spare(n + 32), kept, others;
    const Key limit = static_cast<Key>(0.6);
    for (int k = 0; k < n + 32; k++) {
      key[k] = static_cast<Key>(uniform());
      index[k] = 100 + k;
      if (k < n) (key[k] < limit ? kept : others).push_back(index[k]);
    }
    const std::vector<Key> before = key;
    const int m = part(key.data(), index.data(), n, limit, spare.data());
    kept.insert(kept.end(), others.begin(), others.end());
    CHECK(m == n - static_cast<int>(others.size()));
    for (int k = 0; k < n + 32; k++) CHECK(index[k] == (k < n ? kept[k] : 100 + k));
    for (int k = 0; k < m; k++) CHECK(key[k] == before[kept[k] - 100]);
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
  for (int n = 0; n < 30; n++) {
    std::vector<int> index(whole_groups(n) + LANES);
    for (int &i : index) i = static_cast<int>(39 * uniform());
    std::vector<Lane> x(40), y(40), z(40);
    std::vector<Last> w(40);
    columns(&records[0].x, index.data(), n, x.data(), y.data(), z.data(), w.data());
    for (int k = 0; k < n; k++) {
      const Record &r = records[index[k]];
      CHECK(x[k] == r.x && y[k] == r.y && z[k] == r.z && w[k] == r.w);
    }
  }
}

}    // namespace

CASE("compaction keeps what is below the limit, in order")
{
  check_compact<float>();
  check_compact<double>();
}

CASE("partition of a list in place")
{
  check_partition<float>([](auto... a) { return partition(a...); });
  check_partition<double>([](auto... a) { return partition(a...); });
  check_partition<float>([](auto... a) { return partition_plain(a...); });
  check_partition<double>([](auto... a) { return partition_plain(a...); });
}

CASE("columns of records")
{
  check_columns<double, double>();
  check_columns<float, float>();
  check_columns<std::int32_t, float>();
}
