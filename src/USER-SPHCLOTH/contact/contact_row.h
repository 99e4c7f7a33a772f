// SPDX-License-Identifier: GPL-2.0-or-later
// A contact between vertices: signed weights of four of them and a normal, by which it pushes all
// four, equal and opposite.  Rows are solved at once, with the mass of a vertex split evenly over its
// rows, which keeps momentum and always converges: Tonge, Benevolenski & Voroshilov, ACM Trans.
// Graph. 31 (2012) 105.

#ifndef SPHCLOTH_CONTACT_CONTACT_ROW_H
#define SPHCLOTH_CONTACT_CONTACT_ROW_H

#include "cloth/vertex_halo.h"
#include "contact/cloth_candidates.h"

#include <array>
#include <vector>

namespace LAMMPS_NS {

struct ContactRow {
  using Vec3 = Eigen::Vector3d;

  sphcloth::PairKind kind;
  std::array<int, 4> slots;    // see ClothPair
  std::array<int, 2> members;
  std::array<double, 4> weight;
  Vec3 normal;    // from the second side to the first
  double gap = 0.0;    // to be kept
  double awake_from = 0.0;    // path of vertices before which there is no contact
  bool active = false;    // in this substep
  double normal_correction = 0.0;    // of this substep, mass times length
  Vec3 friction_correction = Vec3::Zero();    // the same across the normal
  double speed_before = 0.0;    // along the normal

  // of the first side relative to the second
  Vec3 relative(const std::vector<Vec3> &of) const
  {
    return weight[0] * of[slots[0]] + weight[1] * of[slots[1]] + weight[2] * of[slots[2]] +
        weight[3] * of[slots[3]];
  }
  sphcloth::FourPoints of_slots(const std::vector<Vec3> &of) const
  {
    return {of[slots[0]], of[slots[1]], of[slots[2]], of[slots[3]]};
  }
};

// by how many rows the mass of each vertex is split, and what rows push in a pass

class SplitMasses {
 public:
  using Vec3 = Eigen::Vector3d;

  std::vector<Vec3> impulse;    // by slot

  void begin(int n_slots) { rows_at.assign(n_slots, Vec3::Zero()); }
  void count(const ContactRow &row)
  {
    for (const int s : row.slots) rows_at[s][0] += 1.0;
  }
  // collective: rows of all ranks
  void share(VertexHalo &halo)
  {
    halo.reverse_add(0, rows_at.data());
    halo.forward(0, rows_at.data());
  }

  // 0 if nothing can move; a row that was not counted counts itself
  double of(const ContactRow &row, const std::vector<double> &inverse_mass) const
  {
    double inverse = 0.0;
    for (int k = 0; k < 4; k++) {
      const int s = row.slots[k];
      inverse += inverse_mass[s] * std::max(1.0, rows_at[s][0]) * row.weight[k] * row.weight[k];
    }
    return inverse > 0.0 ? 1.0 / inverse : 0.0;
  }

  void clear_impulses() { impulse.assign(rows_at.size(), Vec3::Zero()); }
  void apply(const ContactRow &row, const Vec3 &by)
  {
    for (int k = 0; k < 4; k++) impulse[row.slots[k]] += row.weight[k] * by;
  }

  double bytes() const { return sphcloth::bytes_of(impulse, rows_at); }

 private:
  std::vector<Vec3> rows_at;    // in [0]
};

}    // namespace LAMMPS_NS

#endif
