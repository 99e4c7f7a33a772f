// SPDX-License-Identifier: GPL-2.0-or-later
// Counting sort of items into buckets, for grids, blocks and topologies.

#ifndef SPHCLOTH_CORE_GEOMETRY_BUCKETS_H
#define SPHCLOTH_CORE_GEOMETRY_BUCKETS_H

#include <cstddef>
#include <vector>

namespace sphcloth {

// for_each(add) calls add(bucket, item) for every entry, twice the same.  Those of bucket b become
// items[first[b]] to items[first[b + 1] - 1], in the order in which they came.  Buffers are kept.

template <class ForEach>
void sort_into_buckets(std::size_t n_buckets, ForEach for_each, std::vector<int> &first,
                       std::vector<int> &items)
{
  first.assign(n_buckets + 1, 0);
  for_each([&](std::size_t bucket, int) { first[bucket]++; });
  int before = 0;
  for (int &start : first) {
    const int count = start;
    start = before;
    before += count;
  }
  items.resize(before);
  for_each([&](std::size_t bucket, int item) { items[first[bucket]++] = item; });
  for (std::size_t b = n_buckets; b > 0; b--) first[b] = first[b - 1];
  first[0] = 0;
}

}    // namespace sphcloth

#endif
