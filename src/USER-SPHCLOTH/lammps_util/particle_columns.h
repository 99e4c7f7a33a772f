// SPDX-License-Identifier: GPL-2.0-or-later
// What a fix keeps for each particle, column by column: a pass over all particles that needs one
// number of each reads nothing else.

#ifndef SPHCLOTH_LAMMPS_UTIL_PARTICLE_COLUMNS_H
#define SPHCLOTH_LAMMPS_UTIL_PARTICLE_COLUMNS_H

#include "core/util/bytes.h"

#include <algorithm>
#include <vector>

namespace LAMMPS_NS {

class ParticleColumns {
 public:
  // all zero; n columns, none: nothing is kept
  void create(int n, int particles) { columns.assign(n, std::vector<double>(particles, 0.0)); }
  void grow(int particles)
  {
    for (auto &column : columns) column.resize(particles, 0.0);
  }

  bool empty() const { return columns.empty(); }
  int count() const { return static_cast<int>(columns.size()); }
  double *operator[](int column) { return columns[column].data(); }
  const double *operator[](int column) const { return columns[column].data(); }

  void clear()
  {
    for (auto &column : columns) std::fill(column.begin(), column.end(), 0.0);
  }

  // of one particle
  void clear(int i)
  {
    for (auto &column : columns) column[i] = 0.0;
  }
  void copy(int from, int to)
  {
    for (auto &column : columns) column[to] = column[from];
  }
  double *pack(int i, double *buf) const
  {
    for (const auto &column : columns) *buf++ = column[i];
    return buf;
  }
  void unpack(int i, const double *buf)
  {
    for (auto &column : columns) column[i] = *buf++;
  }

  double bytes() const
  {
    double sum = 0.0;
    for (const auto &column : columns) sum += sphcloth::bytes_of(column);
    return sum;
  }

 private:
  std::vector<std::vector<double>> columns;
};

}    // namespace LAMMPS_NS

#endif
