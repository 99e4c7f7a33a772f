// SPDX-License-Identifier: GPL-2.0-or-later
// What buffers hold on to, for memory_usage().

#ifndef SPHCLOTH_CORE_UTIL_BYTES_H
#define SPHCLOTH_CORE_UTIL_BYTES_H

#include <cstddef>

namespace sphcloth {

// of vectors, their capacity times the size of an element
template <class... Vectors> double bytes_of(const Vectors &...vectors)
{
  const auto bytes = [](const auto &v) { return v.capacity() * sizeof(v[0]); };
  return static_cast<double>((std::size_t{0} + ... + bytes(vectors)));
}

}    // namespace sphcloth

#endif
