// SPDX-License-Identifier: GPL-2.0-or-later

#include "core/util/shared_lane.h"

#include <boost/test/unit_test.hpp>

#include <memory>
#include <thread>
#include <vector>

using sphcloth::SharedLane;

BOOST_AUTO_TEST_SUITE(shared_lane)

namespace {

constexpr auto AWAKE = SharedLane::Wait::AWAKE, ASLEEP = SharedLane::Wait::ASLEEP;

// what two processes would map

struct Memory {
  explicit Memory(std::size_t capacity) : page(SharedLane::size_of(capacity) + 64)
  {
    void *at = page.data();
    std::size_t space = page.size();
    begin = std::align(64, page.size() - 64, at, space);
    SharedLane::prepare(begin);
  }
  std::vector<char> page;
  void *begin;
};

}    // namespace

// The reader is slower at times, the writer at others: neither skips a turn or sees half of one.

BOOST_AUTO_TEST_CASE(numbers_arrive_in_order_and_whole)
{
  constexpr int N = 37, TURNS = 20000;
  const Memory memory(N);
  SharedLane out(memory.begin, N, AWAKE), in(memory.begin, N, ASLEEP);
  std::thread writer([&out] {
    for (int turn = 0; turn < TURNS; turn++) {
      double *to = out.begin_write();
      for (int k = 0; k < N; k++) to[k] = turn * N + k;
      out.end_write();
      if (turn % 5000 == 0) std::this_thread::yield();
    }
  });
  int wrong = 0;
  for (int turn = 0; turn < TURNS; turn++) {
    const double *from = in.begin_read();
    for (int k = 0; k < N; k++)
      if (from[k] != turn * N + k) wrong++;
    in.end_read();
    if (turn % 3000 == 0) std::this_thread::yield();
  }
  writer.join();
  BOOST_TEST(wrong == 0);
}

BOOST_AUTO_TEST_CASE(two_turns_wait_for_no_reader)
{
  const Memory memory(1);
  SharedLane out(memory.begin, 1, AWAKE), in(memory.begin, 1, AWAKE);
  for (const double value : {1.0, 2.0}) {
    *out.begin_write() = value;
    out.end_write();
  }
  for (const double value : {1.0, 2.0}) {
    BOOST_TEST(*in.begin_read() == value);
    in.end_read();
  }
}

BOOST_AUTO_TEST_SUITE_END()
