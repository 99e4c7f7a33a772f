// SPDX-License-Identifier: GPL-2.0-or-later
// The time bin of each particle: how long is the base step, what does each particle want, and which
// bins do its neighbors allow?

#ifndef SPHCLOTH_STEPPING_BIN_CHOICE_H
#define SPHCLOTH_STEPPING_BIN_CHOICE_H

#include "pointers.h"

#include "atom.h"
#include "core/timestep/step_limits.h"
#include "stepping/block_state.h"
#include "stepping/stepper.h"

#include <vector>

namespace LAMMPS_NS {

class BinChoice : protected Pointers {
 public:
  BinChoice(LAMMPS *, const SteppingParts &, BlockState &);

  void init(FluidState *);
  // for particles whose step begins
  void choose();
  // of the vertices of this rank, which move in every smallest step
  void limit_vertices();
  double bytes() const;

 private:
  struct Vertices {    // of this rank when their limits were found
    int n = -1;    // not known
    sphcloth::StepLimit tightest{0.0, sphcloth::Limit::NONE};
  };
  struct BaseStep {
    double length, remaining, output_time;    // remaining until that
    sphcloth::Limit by;    // of the tightest
    bool uniform;    // all particles take it
  };

  struct Sums {    // of all ranks
    double exact = 0.0;    // updates if each particle took exactly the step that it wants,
    double equal = 0.0;    // while a uniform step has so many
    double at_rest = 0.0;    // particles that sleep, or will
  };

  const SteppingParts parts;
  BlockState &state;
  FluidState *fluid;
  int max_difference;    // of the time bins of neighbors
  std::vector<int> max_difference_of;    // the same of a pair of types, [(ntypes+1)^2]
  int finest_vertex;    // time bin of the shortest step of a vertex
  Vertices vertices;
  std::vector<double> wanted;    // step, by owned atom
  double sum_of_rates = 0.0;    // of 1/wanted of the active particles, where a base step begins
  std::vector<int> in_flight;

  int find_max_difference(int type, int neighbor_type) const;
  int allowed_difference(int type, int neighbor_type) const
  {
    return max_difference_of[type * (atom->ntypes + 1) + neighbor_type];
  }
  const Vertices &find_vertices();

  sphcloth::StepLimit want_steps(const std::vector<int> &of, bool ask_neighbors);
  void begin_base_step();
  BaseStep find_base_step(sphcloth::StepLimit tightest);
  void control_step();
  double longest_wanted() const;
  Sums sum_everywhere(double shortest);
  void begin_equal_steps();
  void find_bins();
  void limit_differences();
  int vertex_bin(int i) const;
  bool is_too_coarse(int i) const;
  int bin_beside(int i) const;
  void begin_steps();
};

}    // namespace LAMMPS_NS

#endif
