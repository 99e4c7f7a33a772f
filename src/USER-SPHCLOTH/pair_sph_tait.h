// pair_style sph/tait: weakly compressible SPH, equations (1) to (3), with boundary particles.

#ifdef PAIR_CLASS
// clang-format off
PairStyle(sph/tait,PairSPHTait);
// clang-format on
#else

#ifndef LMP_PAIR_SPH_TAIT_H
#define LMP_PAIR_SPH_TAIT_H

#include "pair.h"

#include "fluid/fluid_state.h"

#include <vector>

namespace LAMMPS_NS {

class PairSPHTait : public Pair {
 public:
  PairSPHTait(class LAMMPS *);
  ~PairSPHTait() override;

  void compute(int, int) override;
  void settings(int, char **) override;
  void coeff(int, char **) override;
  void init_style() override;
  double init_one(int, int) override;
  void write_restart(FILE *) override;
  void read_restart(FILE *) override;
  void write_restart_settings(FILE *) override;
  void read_restart_settings(FILE *) override;
  void write_data(FILE *) override;
  void write_data_all(FILE *) override;
  int pack_forward_comm(int, int *, double *, int, int *) override;
  void unpack_forward_comm(int, int, double *) override;
  double memory_usage() override;
  // what fixes, computes and commands ask, see FluidState::find()
  void *extract(const char *, int &) override;

 private:
  enum class Stage { MASS_OR_VOLUME, DENSITY, GRADIENT };

  FluidState fluid;
  std::vector<double> reach;    // of the lists, (ntypes+1)^2, 0: never
  // on any rank, at the last list build: boundary particles whose volume is measured, those whose
  // pressure is the fluid's, fluid
  bool measure_volume = false, extrapolate = false, any_fluid = true;
  std::vector<int> moved, moved_here;    // types of which a particle moves, on any rank and here
  Stage stage = Stage::DENSITY;    // of what ghosts get

  void allocate();
  bool excluded(int, int) const;
  sphcloth::Fluid::Box box() const;
  sphcloth::Motion usual_motion(const sphcloth::Particles &) const;
  void measure_volumes(const sphcloth::Particles &, bool new_neighbors);
  void densities(const sphcloth::Particles &);
  void integrate_density(const sphcloth::Particles &);
  void density_rates(const sphcloth::Particles &, double back);
  void boundary_pressures(const sphcloth::Particles &);
  void push(FluidBoundary &);
  void tally_virial(sphcloth::Particles);
  void tally_energy();
  void send_to_ghosts(Stage);
};

}    // namespace LAMMPS_NS

#endif
#endif
