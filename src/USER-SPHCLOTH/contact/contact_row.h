// SPDX-License-Identifier: GPL-2.0-or-later
// A contact between vertices, or a particle and vertices: signed weights of four of them and a
// normal, by which it pushes all four, equal and opposite.  Rows are solved at once, with the mass
// of a vertex split over its rows, evenly or as these push, which keeps momentum and always
// converges: Tonge, Benevolenski & Voroshilov, ACM Trans. Graph. 31 (2012) 105.

#ifndef SPHCLOTH_CONTACT_CONTACT_ROW_H
#define SPHCLOTH_CONTACT_CONTACT_ROW_H

#include "cloth/vertex_halo.h"
#include "contact/contact_pair.h"
#include "core/util/bytes.h"

#include <algorithm>
#include <array>
#include <vector>

namespace LAMMPS_NS {

// two cache lines of what is read in each pass; what is rarely read is kept elsewhere

struct alignas(64) ContactRow {
  using Vec3 = Eigen::Vector3d;

  std::array<int, 4> slots;    // see ContactPair
  std::array<double, 4> weight;
  Vec3 normal;    // from the second side to the first
  double distance = 0.0;    // along it where weights were found
  double gap = 0.0;    // to be kept
  double share = 1.0;    // how much the row counts
  double mass = 0.0;    // effective
  double normal_correction = 0.0;    // of this substep, mass times length
  sphcloth::PairKind kind;
  Meeting meeting;
  bool active = false;    // in this substep
  bool in_corner = false;    // of a particle on two faces

  ContactRow(const ContactPair &pair, const std::array<double, 4> &weight_, const Vec3 &normal_,
             double gap_) :
      slots(pair.slots), weight(weight_), normal(normal_), gap(gap_), kind(pair.kind),
      meeting(pair.meeting)
  {
  }
  // of the first side relative to the second
  Vec3 relative(const std::vector<Vec3> &of) const
  {
    return weight[0] * of[slots[0]] + weight[1] * of[slots[1]] + weight[2] * of[slots[2]] +
        weight[3] * of[slots[3]];
  }
  // a distance that is no number pushes: it must be seen
  bool pushes(double distance_now) const
  {
    return normal_correction != 0.0 || (share != 0.0 && !(distance_now >= gap));
  }
  bool is_inside_both() const { return sphcloth::inside_both(kind, {weight, normal}); }
  sphcloth::FourPoints of_slots(const std::vector<Vec3> &of) const
  {
    return {of[slots[0]], of[slots[1]], of[slots[2]], of[slots[3]]};
  }
};

inline void add(sphcloth::Vertex &vertex, const Eigen::Vector3d &by)
{
  vertex.x += by[0];
  vertex.y += by[1];
  vertex.z += by[2];
}

// by what the mass of each vertex is split, and what rows push in a pass

class SplitMasses {
 public:
  using Vec3 = Eigen::Vector3d;

  std::vector<Vec3> impulse;    // by slot

  void begin(std::size_t n_slots) { shares.assign(n_slots, Vec3::Zero()); }
  // the share of a row in a mass grows with its weight there, and with how much it counts at all
  void count(const ContactRow &row) { count(row, row.share); }
  void count(const ContactRow &row, double share)
  {
    for (int k = 0; k < 4; k++) shares[row.slots[k]][0] += share * std::fabs(row.weight[k]);
  }
  // behind begin(); collective: rows of all ranks
  void share(VertexHalo &halo)
  {
    halo.reverse_add(0, shares.data());
    halo.forward(0, shares.data());
  }

  // 0 if nothing can move; a row that was not counted counts itself
  double of(const ContactRow &row, const std::vector<double> &inverse_mass) const
  {
    const double inverse = split(row, 0, row.share, shares, inverse_mass);
    return inverse > 0.0 ? row.share / inverse : 0.0;
  }
  // without the first member, inverse
  double inverse_of_others(const ContactRow &row, const std::vector<double> &inverse_mass) const
  {
    return row.share > 0.0 ? split(row, 1, row.share, shares, inverse_mass) / row.share : 0.0;
  }

  // with other rows, of what can move
  bool are_shared(const ContactRow &row, const std::vector<double> &inverse_mass) const
  {
    for (int k = 0; k < 4; k++) {
      const int s = row.slots[k];
      if (inverse_mass[s] > 0.0 && shares[s][0] > row.share * std::fabs(row.weight[k])) return true;
    }
    return false;
  }

  // The same by load, so that a row that hardly pushes hardly counts: what rows push more in a
  // substep is added, also behind sharing, which sums what all ranks have so far.  Collective.
  void clear_loads() { clear(loads); }
  void add_load(const ContactRow &row, double load)
  {
    for (int k = 0; k < 4; k++) loads[row.slots[k]][0] += load * std::fabs(row.weight[k]);
  }
  void share_loads(VertexHalo &halo)
  {
    of_all_ranks = loads;
    halo.reverse_add(0, of_all_ranks.data());
    halo.forward(0, of_all_ranks.data());
  }
  double by_load(const ContactRow &row, const std::vector<double> &inverse_mass) const
  {
    const double load = row.normal_correction,
                 inverse = split(row, 0, load, of_all_ranks, inverse_mass);
    return inverse > 0.0 ? load / inverse : 0.0;
  }
  double inverse_of_others_by_load(const ContactRow &row,
                                   const std::vector<double> &inverse_mass) const
  {
    const double load = row.normal_correction;
    return load > 0.0 ? split(row, 1, load, of_all_ranks, inverse_mass) / load : 0.0;
  }

  void clear_impulses() { clear(impulse); }
  void apply(const ContactRow &row, const Vec3 &by)
  {
    for (int k = 0; k < 4; k++) impulse[row.slots[k]] += row.weight[k] * by;
  }

  double bytes() const { return sphcloth::bytes_of(impulse, shares, loads, of_all_ranks); }

 private:
  std::vector<Vec3> shares, loads, of_all_ranks;    // by slot, in [0]; the last of loads

  // inverse masses from the member `first` on, each times what all rows have of it
  static double split(const ContactRow &row, int first, double part,
                      const std::vector<Vec3> &of_all, const std::vector<double> &inverse_mass)
  {
    double inverse = 0.0;
    for (int k = first; k < 4; k++) {
      const int s = row.slots[k];
      const double weight = std::fabs(row.weight[k]);
      inverse += inverse_mass[s] * weight * std::max(part * weight, of_all[s][0]);
    }
    return inverse;
  }

  // as one block of numbers: in every pass, of all slots
  void clear(std::vector<Vec3> &of) const
  {
    of.resize(shares.size());
    if (!of.empty()) std::fill_n(of[0].data(), 3 * of.size(), 0.0);
  }
};

}    // namespace LAMMPS_NS

#endif
