// SPDX-License-Identifier: GPL-2.0-or-later
// The time loop: move, communicate, evaluate, choose the next step.

#include "sph_adaptive.h"

#include "angle.h"
#include "atom.h"
#include "bond.h"
#include "comm.h"
#include "dihedral.h"
#include "domain.h"
#include "error.h"
#include "fix_sph_integrate.h"
#include "fluid/fluid_state.h"
#include "force.h"
#include "group.h"
#include "improper.h"
#include "kspace.h"
#include "lammps_util/arg_reader.h"
#include "lammps_util/lammps_version.h"
#include "modify.h"
#include "neighbor.h"
#include "output.h"
#include "pair.h"
#include "timer.h"
#include "update.h"

using namespace LAMMPS_NS;

static const std::string STYLE = "run_style sph/adaptive";

// run_style sph/adaptive [constant|global|individual|block]

SPHAdaptive::SPHAdaptive(LAMMPS *lmp_, int narg, char **arg) :
    Verlet(lmp_, narg, arg), stepping(SteppingScheme::GLOBAL), particles(nullptr),
    fluid_alone(false)
{
  ArgReader args(lmp, STYLE, narg, arg);
  if (!args.more()) return;
  stepping = static_cast<SteppingScheme>(
      args.choice("scheme", {"constant", "global", "individual", "block"}));
  if (args.more()) args.unknown(args.peek(), "no keyword after the scheme");
}

void SPHAdaptive::init()
{
  const auto fixes = modify->get_fix_by_style("^sph/integrate$");
  if (fixes.size() != 1)
    error->all(FLERR, "{}: needs one fix sph/integrate, there are {}: it says who is integrated",
               STYLE, fixes.size());
  particles = dynamic_cast<FixSPHIntegrate *>(fixes[0]);

  // LAMMPS's own fixes take every style whose name does not begin with verlet for rRESPA
  delete[] update->integrate_style;
  update->integrate_style = utils::strdup("verlet/sph/adaptive");
  Verlet::init();
  const FluidState *fluid = FluidState::find(force);
  fluid_alone = fluid && fluid->is_of(force->pair);
}

// As Verlet::setup(), but for the first step: it follows from the forces of all fixes, and the
// first output shows it.

void SPHAdaptive::setup(int flag)
{
  if (comm->me == 0 && screen) {
    release::print(screen, "Setting up {} run ...\n", STYLE);
    if (flag) {
      release::print(screen, "  Unit style    : {}\n  Current step  : {}\n  Time step     : {}\n",
                     update->unit_style, update->ntimestep, update->dt);
      timer->print_timeout(screen);
    }
  }
  update->setupflag = 1;
  set_up_atoms();
  set_up_forces();
  particles->begin_steps();
  output->setup(flag);
  update->setupflag = 0;
}

void SPHAdaptive::setup_minimal(int flag)
{
  Verlet::setup_minimal(flag);
  particles->begin_steps();
}

void SPHAdaptive::set_up_atoms()
{
  atom->setup();
  modify->setup_pre_exchange();
  if (triclinic) domain->x2lamda(atom->nlocal);
  domain->pbc();
  domain->reset_box();
  comm->setup();
  if (neighbor->style) neighbor->setup_bins();
  comm->exchange();
  if (atom->sortfreq > 0) atom->sort();
  comm->borders();
  if (triclinic) domain->lamda2x(atom->nlocal + atom->nghost);
  domain->image_check();
  domain->box_too_small_check();
  modify->setup_pre_neighbor();
  neighbor->build(1);
  modify->setup_post_neighbor();
  neighbor->ncalls = 0;
}

// LAMMPS fills a dynamic group in the setup of its fix, when time bins have been chosen.

void SPHAdaptive::fill_dynamic_group()
{
  if (!group->dynamic[particles->igroup]) return;
  const std::string fills = std::string("GROUP_") + group->names[particles->igroup];
  if (Fix *fix = modify->get_fix_by_id(fills)) fix->setup(vflag);
}

void SPHAdaptive::set_up_forces()
{
  fill_dynamic_group();
  force->setup();
  ev_set(update->ntimestep);
  force_clear();
  modify->setup_pre_force(vflag);
  if (pair_compute_flag)
    force->pair->compute(eflag, vflag);
  else if (force->pair)
    force->pair->compute_dummy(eflag, vflag);
  if (atom->molecular != Atom::ATOMIC) compute_bonded();
  if (force->kspace) {
    force->kspace->setup();
    if (kspace_compute_flag)
      force->kspace->compute(eflag, vflag);
    else
      force->kspace->compute_dummy(eflag, vflag);
  }
  modify->setup_pre_reverse(eflag, vflag);
  if (force->newton) comm->reverse_comm();
  modify->setup(vflag);
}

void SPHAdaptive::run(int n)
{
  for (int i = 0; i < n; i++) {
    if (timer->check_timeout(i)) {
      update->nsteps = i;
      break;
    }
    update->ntimestep++;
    ev_set(update->ntimestep);
    move();
    communicate();
    evaluate();
    finish();
    if (update->ntimestep == output->next) {
      timer->stamp();
      output->write(update->ntimestep);
      timer->stamp(Timer::OUTPUT);
    }
  }
}

// lines 19 to 33: fluid and cloth move, then contact parts them

void SPHAdaptive::move()
{
  timer->stamp();
  modify->initial_integrate(vflag);
  if (modify->n_post_integrate) modify->post_integrate();
  timer->stamp(Timer::MODIFY);
}

// lines 6 and 7: new neighbor lists if a particle has moved far enough, otherwise ghost positions

void SPHAdaptive::communicate()
{
  if (!neighbor->decide()) {
    timer->stamp();
    comm->forward_comm();
    timer->stamp(Timer::COMM);
    return;
  }
  if (modify->n_pre_exchange) {
    timer->stamp();
    modify->pre_exchange();
    timer->stamp(Timer::MODIFY);
  }
  if (triclinic) domain->x2lamda(atom->nlocal);
  domain->pbc();
  if (domain->box_change) {
    domain->reset_box();
    comm->setup();
    if (neighbor->style) neighbor->setup_bins();
  }
  timer->stamp();
  comm->exchange();
  if (atom->sortfreq > 0 && update->ntimestep >= atom->nextsort) atom->sort();
  comm->borders();
  if (triclinic) domain->lamda2x(atom->nlocal + atom->nghost);
  timer->stamp(Timer::COMM);
  if (modify->n_pre_neighbor) {
    modify->pre_neighbor();
    timer->stamp(Timer::MODIFY);
  }
  neighbor->build(1);
  timer->stamp(Timer::NEIGH);
  if (modify->n_post_neighbor) {
    modify->post_neighbor();
    timer->stamp(Timer::MODIFY);
  }
}

// lines 8 to 16: densities, pressures, accelerations

void SPHAdaptive::evaluate()
{
  force_clear();
  timer->stamp();
  if (modify->n_pre_force) {
    modify->pre_force(vflag);
    timer->stamp(Timer::MODIFY);
  }
  if (pair_compute_flag) {
    force->pair->compute(eflag, vflag);
    timer->stamp(Timer::PAIR);
  }
  if (atom->molecular != Atom::ATOMIC) {
    compute_bonded();
    timer->stamp(Timer::BOND);
  }
  if (kspace_compute_flag) {
    force->kspace->compute(eflag, vflag);
    timer->stamp(Timer::KSPACE);
  }
  if (modify->n_pre_reverse) {
    modify->pre_reverse(eflag, vflag);
    timer->stamp(Timer::MODIFY);
  }
  if (ghosts_have_forces()) {
    comm->reverse_comm();
    timer->stamp(Timer::COMM);
  }
  if (modify->n_post_force_any) modify->post_force(vflag);
  timer->stamp(Timer::MODIFY);
}

void SPHAdaptive::compute_bonded()
{
  if (force->bond) force->bond->compute(eflag, vflag);
  if (force->angle) force->angle->compute(eflag, vflag);
  if (force->dihedral) force->dihedral->compute(eflag, vflag);
  if (force->improper) force->improper->compute(eflag, vflag);
}

// pair_style sph/tait gives no forces to ghosts.

bool SPHAdaptive::ghosts_have_forces() const
{
  if (!force->newton) return false;
  return atom->molecular != Atom::ATOMIC || kspace_compute_flag || modify->n_pre_force ||
      modify->n_pre_reverse || !fluid_alone;
}

// lines 17, 18 and 34: the step is booked and the next one chosen

void SPHAdaptive::finish()
{
  timer->stamp();
  modify->final_integrate();
  if (modify->n_end_of_step) modify->end_of_step();
  particles->finish_step();
  timer->stamp(Timer::MODIFY);
}
