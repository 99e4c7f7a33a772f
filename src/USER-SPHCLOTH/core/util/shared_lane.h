// SPDX-License-Identifier: GPL-2.0-or-later
// One way between two processes, in memory that both see: one writes numbers, the other reads them.
// Two buffers in turn, so that the writer need not wait for the reader of the last ones.

#ifndef SPHCLOTH_CORE_UTIL_SHARED_LANE_H
#define SPHCLOTH_CORE_UTIL_SHARED_LANE_H

#include <atomic>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <new>
#include <thread>

namespace sphcloth {

class SharedLane {
 public:
  // How an end waits.  Where there are fewer cores than processes, one that sleeps lets the one
  // that it waits for run.
  enum class Wait { AWAKE, ASLEEP };

  // in bytes, for up to `capacity` numbers at a time
  static std::size_t size_of(std::size_t capacity)
  {
    return sizeof(Header) + 2 * capacity * sizeof(double);
  }

  // once, before there are ends.  The memory begins where a page does.
  static void prepare(void *memory) { new (memory) Header; }

  SharedLane(void *memory, std::size_t capacity_, Wait wait_) :
      header(static_cast<Header *>(memory)), capacity(capacity_), wait(wait_)
  {
  }

  // Each returns a buffer, and waits until it is free, or full.  Writer and reader do the same
  // number of times.
  double *begin_write()
  {
    wait_until([this] { return turns < header->read.load(std::memory_order_acquire) + 2; });
    return buffer();
  }
  void end_write() { header->written.store(++turns, std::memory_order_release); }
  const double *begin_read()
  {
    wait_until([this] { return turns < header->written.load(std::memory_order_acquire); });
    return buffer();
  }
  void end_read() { header->read.store(++turns, std::memory_order_release); }

 private:
  // in two cache lines, since each end writes its own
  struct Header {
    alignas(64) std::atomic<std::uint64_t> written{0};
    alignas(64) std::atomic<std::uint64_t> read{0};
  };
  static_assert(std::atomic<std::uint64_t>::is_always_lock_free, "processes share no locks");

  Header *header;
  std::size_t capacity;
  Wait wait;
  std::uint64_t turns = 0;    // so many times written, or read, by this end

  double *buffer() const { return reinterpret_cast<double *>(header + 1) + (turns % 2) * capacity; }

  // A sleep of a nanosecond takes as long as the system lets it, some 50 us.
  template <class Ready> void wait_until(Ready ready) const
  {
    constexpr int SPINS = 2000;
    for (int n = 0; !ready(); n++) {
      if (n < SPINS) continue;
      if (wait == Wait::ASLEEP)
        std::this_thread::sleep_for(std::chrono::nanoseconds(1));
      else
        std::this_thread::yield();
    }
  }
};

}    // namespace sphcloth

#endif
