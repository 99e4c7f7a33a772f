// Position-based dynamics of cloth: (4) to (9) and lines 19 to 29 of Algorithm 1.
//
// Constraints (cloth/cloth_constraints.h) are projected colour by colour; after a colour only the
// vertices that it moved are forwarded to other ranks.

#include "fix_pbd_cloth.h"

#include "atom.h"
#include "bond_pbd.h"
#include "comm.h"
#include "core/util/bytes.h"
#include "domain.h"
#include "error.h"
#include "force.h"
#include "group.h"
#include "integrate.h"
#include "lammps_util/arg_reader.h"
#include "lammps_util/atom_tools.h"
#include "lammps_util/rank_error.h"
#include "lammps_util/restart_record.h"
#include "memory.h"
#include "modify.h"
#include "stepping/stepping_scheme.h"
#include "update.h"

#include <algorithm>
#include <cmath>
#include <limits>

using namespace LAMMPS_NS;
using namespace FixConst;
using namespace sphcloth;

// columns of `hold`: pull of the cloth, and gap between an attached vertex and where the solver left it
static constexpr int GAP = 3, HOLD = 6;

// Share of that gap which is closed in a step.  A quarter damps any oscillation between the
// body and what holds it within a few steps, whatever their masses; with 1 it would go on for ever.
static constexpr double CLOSED = 0.25;

// Of substeps: by how much those of a step may be longer than those of the step before, and how many times
// as many as in the shortest step of late a step may have.
static constexpr double LENGTHENS = 1.01, MOST_TIMES = 8.0;

// impulse before the first step
static constexpr double NOT_YET = std::numeric_limits<double>::quiet_NaN();

/* ----------------------------------------------------------------------
   fix ID group pbd/cloth keyword value ...
------------------------------------------------------------------------- */

FixPBDCloth::FixPBDCloth(LAMMPS *lmp_, int narg, char **arg) :
    Fix(lmp_, narg, arg), label(fmt::format("fix {} pbd/cloth", id)), solver(Solver::SUBSTEPS),
    iterations(10), symmetric_sweeps(false), from_start(true), tolerance(0.0), step_given(0.0),
    step_of_k(0.0), pinbit(0), pin_motion(lmp, label), attachbit(0), damping(0.0), rest_x(nullptr),
    hold(nullptr), lent(nullptr), mesh(lmp, label), constraints(lmp, label, mesh), halo(lmp),
    holding{}, sweeps(0), remembered(true), last_residual(0.0), last_energy(0.0), started(false),
    steps_jump(false), step_dt(0.0), shortest_of_late(std::numeric_limits<double>::infinity()),
    substeps(1)
{
  time_integrate = 1;
  restart_peratom = 1;
  restart_global = 1;
  create_attribute = 1;
  vector_flag = 1;
  size_vector = 10;
  global_freq = 1;
  extvector = 0;
  comm_forward = VertexHalo::LINK;

  if (atom->molecular != Atom::MOLECULAR || !atom->num_bond)
    error->all(FLERR,
               "{}: atom_style {} has no bonds: use atom_style molecular, or hybrid sph molecular",
               label, atom->atom_style);
  if (group->count(igroup) == 0)
    error->all(FLERR, "{}: group {} has no atoms: create the cloth before this fix", label,
               group->names[igroup]);

  FixPBDCloth::grow_arrays(atom->nmax);
  atom->add_callback(Atom::GROW);
  atom->add_callback(Atom::RESTART);
  for (int i = 0; i < atom->nlocal; i++) domain->unmap(atom->x[i], atom->image[i], rest_x[i]);

  ArgReader args(lmp, label, narg, arg, 3);
  read_options(args);

  // a pinned vertex rests until another fix moves it
  for (int i = 0; i < atom->nlocal; i++)
    if (atom->mask[i] & groupbit && atom->mask[i] & pinbit)
      std::fill(atom->v[i], atom->v[i] + 3, 0.0);
}

void FixPBDCloth::read_options(ArgReader &args)
{
  bool solver_given = false;
  while (args.more()) {
    const std::string keyword = args.word("keyword");
    if (keyword == "iterations")
      iterations = args.integer("iterations", 1, 100000);
    else if (keyword == "solver") {
      solver = static_cast<Solver>(args.choice(keyword, {"gs", "jacobi", "substeps"}));
      solver_given = true;
    } else if (keyword == "order")
      symmetric_sweeps = args.choice(keyword, {"forward", "symmetric"});
    else if (keyword == "direction")
      from_start = args.choice(keyword, {"current", "start"});
    else if (keyword == "tolerance")
      tolerance = args.positive(keyword);
    else if (keyword == "reference")
      step_given = args.positive(keyword);
    else if (keyword == "pin")
      pinbit = read_held(args, keyword);
    else if (keyword == "velocity")
      pin_motion.read(args);
    else if (keyword == "attach")
      attachbit = read_held(args, keyword);
    else if (keyword == "damping")
      damping = args.at_least("damping rate", 0.0);
    else if (keyword == "rest")
      take_rest_positions(args.word("rest property").c_str());
    else
      args.unknown(
          keyword,
          "iterations, solver, order, direction, tolerance, reference, pin, velocity, attach, damping, "
          "rest");
  }
  if (pin_motion && !pinbit)
    error->all(FLERR, "{}: velocity is that of pins: name their group with 'pin'", label);
  if (pinbit && attachbit && share_atoms(atom, pinbit, attachbit, world))
    error->all(FLERR, "{}: a vertex is in the group of pin and in that of attach: it can be in one",
               label);
  if (!solver_given && (attachbit || tolerance > 0.0)) solver = Solver::GAUSS_SEIDEL;
  if (attachbit && solver == Solver::SUBSTEPS)
    args.fail("solver", "substeps",
              "bodies feel attached cloth once a step: use 'solver gs' or 'solver jacobi'");
  if (symmetric_sweeps && solver == Solver::JACOBI)
    args.fail("order", "symmetric", "the sweeps of 'solver jacobi' have no order: leave it away");
  if (attachbit) want_reaction_forces();
  if (solver == Solver::SUBSTEPS) {
    memory->create(lent, atom->nmax, 3, "pbd/cloth:lent");
    std::fill_n(lent[0], 3 * atom->nmax, NOT_YET);
  }
  if (tolerance > 0.0 && solver == Solver::SUBSTEPS)
    args.fail("tolerance", std::to_string(tolerance),
              "substeps have one sweep each: use 'solver gs' or 'solver jacobi'");
}

// group of the vertices that something else moves

int FixPBDCloth::read_held(ArgReader &args, const std::string &keyword)
{
  const std::string name = args.word(keyword + " group");
  const int held = group->find(name);
  if (held < 0) args.fail(keyword + " group", name, "define it with the group command first");
  if (!share_atoms(atom, groupbit, group->bitmask[held], world))
    args.fail(
        keyword + " group", name,
        fmt::format("it has no vertex of group {}: choose among the cloth's vertices or leave "
                    "the keyword away",
                    group->names[igroup]));
  return group->bitmask[held];
}

void FixPBDCloth::take_rest_positions(const char *property)
{
  int flag, cols;
  const std::string name = utils::strmatch(property, "^d2_") ? property + 3 : property;
  const int index = atom->find_custom(name.c_str(), flag, cols);
  if (index < 0 || flag != 1 || cols != 3)
    error->all(FLERR,
               "{}: rest property '{}' does not exist: define it with 'fix ID all property/atom "
               "d2_{} 3' and read it from the data file",
               label, property, name);
  int mine = 0, any = 0;
  for (int i = 0; i < atom->nlocal; i++)
    for (int d = 0; d < 3; d++) {
      rest_x[i][d] = atom->darray[index][i][d];
      if (atom->mask[i] & groupbit && rest_x[i][d] != 0.0) mine = 1;
    }
  MPI_Allreduce(&mine, &any, 1, MPI_INT, MPI_MAX, world);
  if (!any)
    error->all(FLERR,
               "{}: rest property '{}' is 0 everywhere: fill it with 'set', from the data file, or "
               "from the restart file by the fix ID that it was written with",
               label, property);
}

FixPBDCloth::~FixPBDCloth()
{
  atom->delete_callback(id, Atom::GROW);
  atom->delete_callback(id, Atom::RESTART);
  memory->destroy(rest_x);
  memory->destroy(hold);
  memory->destroy(lent);
}

FixPBDCloth *FixPBDCloth::find(LAMMPS *lmp, const std::string &asking, const std::string &id)
{
  auto *fix = dynamic_cast<FixPBDCloth *>(lmp->modify->get_fix_by_id(id));
  if (!fix)
    lmp->error->all(FLERR, "{}: there is no fix pbd/cloth with the ID '{}': define it before",
                    asking, id);
  return fix;
}

int FixPBDCloth::setmask()
{
  return POST_INTEGRATE | POST_NEIGHBOR | (attachbit ? PRE_REVERSE : 0);
}

/* ----------------------------------------------------------------------
   the mesh and what follows from it
------------------------------------------------------------------------- */

void FixPBDCloth::init()
{
  couplings.clear();
  check_overlap();
  check_masses();
  mesh.gather(groupbit);
  if (!mesh.edges.size())
    error->all(FLERR, "{}: group {} has no bonds: create the cloth with create_cloth or read_data",
               label, group->names[igroup]);
  check_styles();
  const auto *adaptive = dynamic_cast<HasSteppingScheme *>(update->integrate);
  steps_jump = adaptive && adaptive->scheme() == SteppingScheme::BLOCK;
  step_of_k = step_of_stiffness();
  constraints.measure_rest(groupbit, rest_x);
  constraints.color(symmetric_sweeps ? 2 * iterations : iterations, solver == Solver::JACOBI);
}

void FixPBDCloth::check_overlap()
{
  for (Fix *other : modify->get_fix_by_style("^pbd/cloth$")) {
    if (other == this) continue;
    if (share_atoms(atom, groupbit, other->groupbit, world))
      error->all(FLERR,
                 "{}: shares vertices with fix {}: give the two fixes groups without common atoms",
                 label, other->id);
  }
}

// Types have masses; only per-atom masses may be missing.

void FixPBDCloth::check_masses()
{
  int mine = 0, massless;
  for (int i = 0; i < atom->nlocal; i++)
    if (atom->mask[i] & groupbit && !(atom_mass(atom, i) > 0.0))
      mine = static_cast<int>(atom->tag[i]);
  MPI_Allreduce(&mine, &massless, 1, MPI_INT, MPI_MAX, world);
  if (massless)
    error->all(FLERR, "{}: vertex {} has no mass: give it one with 'set group {} mass'", label,
               massless, group->names[igroup]);
}

void FixPBDCloth::check_styles()
{
  if (!force->bond || !dynamic_cast<BondPBD *>(force->bond_match("pbd")))
    error->all(FLERR, "{}: bond_style {} holds no stiffness: use 'bond_style pbd'", label,
               force->bond_style ? force->bond_style : "none");
}

// A stiffness that acts once in each step is that of a spring as one over the square of the step.  Where
// steps go to and fro between powers of two that would feed the motion.

double FixPBDCloth::step_of_stiffness() const
{
  if (step_given > 0.0) return step_given;
  if (!steps_jump) return 0.0;
  // other commands than run set up fixes without a run style that looks for what it needs
  const auto steppers = modify->get_fix_by_style("^sph/integrate$");
  return steppers.empty() ? 0.0 : dynamic_cast<HasLongestStep *>(steppers[0])->longest_step();
}

/* ----------------------------------------------------------------------
   this rank's vertices and constraints, after each list build
------------------------------------------------------------------------- */

void FixPBDCloth::post_neighbor()
{
  if (!remembered) remember();    // what the vertices of the last step say before they are gone
  std::vector<int> owned;
  for (int i = 0; i < atom->nlocal; i++)
    if (atom->mask[i] & groupbit) owned.push_back(i);
  halo.reset(constraints.n_channels(), owned);
  constraints.collect(halo);
  halo.connect(this);

  std::vector<double> w(halo.n_slots());
  attached.clear();
  for (int s = 0; s < halo.n_owned(); s++) {
    const int i = halo.atom_of(s);
    w[s] = inverse_mass_in_solver(i);
    if (atom->mask[i] & attachbit) attached.push_back(s);
  }
  halo.forward(ALL, w);
  const std::size_t n = halo.n_slots() + 1;    // and the idle one
  p.assign(n, {});
  for (int s = 0; s < halo.n_slots(); s++) p[s].w = w[s];
  start = p;
  v = p;
  displacement = p;
  kick = w;
  for (int s : attached) kick[s] = 0.0;
  change.assign(solver == Solver::JACOBI ? n : 0, {});
}

bool FixPBDCloth::has_vertex(int i) const { return atom->mask[i] & groupbit; }

bool FixPBDCloth::is_pinned(int i) const { return atom->mask[i] & pinbit; }

bool FixPBDCloth::is_held(int i) const { return atom->mask[i] & (pinbit | attachbit); }

double FixPBDCloth::inverse_mass_in_solver(int i) const
{
  return is_pinned(i) ? 0.0 : 1.0 / atom_mass(atom, i);
}

double FixPBDCloth::inverse_mass(int i) const
{
  return is_held(i) ? 0.0 : 1.0 / atom_mass(atom, i);
}

/* ----------------------------------------------------------------------
   one step: lines 19 to 29 of Algorithm 1
------------------------------------------------------------------------- */

void FixPBDCloth::post_integrate()
{
  if (pin_motion) move_pins();
  cut_step();
  if (lent) lend();
  load();
  if (hold) start_pulls();
  begin_couplings();
  if (step_of_k > 0.0) constraints.rescale_stiffness(step_of_k / usual_substeps(), substep_dt());
  for (int n = 0; n < substeps; n++) substep(n);
  if (hold) apply_reactions();
  store();
  for (SolverCoupling *coupling : present) coupling->end_step();
  remembered = false;
  started = true;
}

// What a sweep leaves of a stretch acts as a spring of the stiffness m/h^2, h the substep, and so does
// a k below 1.  Steps that go to and fro between powers of two would feed what they stretch:
// substeps stay as long as those of the shortest step of late.

void FixPBDCloth::cut_step()
{
  constexpr double ROUNDING = 1e-6;
  step_dt = update->dt;
  substeps = usual_substeps();
  if (solver != Solver::SUBSTEPS || !steps_jump) return;
  shortest_of_late = std::min(LENGTHENS * shortest_of_late, step_dt);
  shortest_of_late = std::max(shortest_of_late, step_dt / MOST_TIMES);
  const double usual = substeps / shortest_of_late;    // per time
  substeps = static_cast<int>(std::ceil(usual * step_dt - ROUNDING));
}

void FixPBDCloth::move_pins()
{
  pin_motion.evaluate(igroup);
  for (int s = 0; s < halo.n_owned(); s++) {
    const int i = halo.atom_of(s);
    if (!is_pinned(i)) continue;
    for (int d = 0; d < 3; d++) {
      atom->v[i][d] = pin_motion.velocity(i, d);
      atom->x[i][d] += update->dt * atom->v[i][d];
    }
  }
}

void FixPBDCloth::begin_couplings()
{
  present.clear();
  if (couplings.empty()) return;
  const double dt = update->dt;
  for (int s = 0; s < halo.n_owned(); s++) {
    const double *f = atom->f[halo.atom_of(s)], by = dt * force->ftm2v * kick[s];
    p[s].x = start[s].x + dt * (v[s].x + by * f[0]);
    p[s].y = start[s].y + dt * (v[s].y + by * f[1]);
    p[s].z = start[s].z + dt * (v[s].z + by * f[2]);
  }
  for (SolverCoupling *coupling : couplings)
    if (coupling->begin_step(start.data(), p.data(), dt)) present.push_back(coupling);
}

// A held vertex is on its way from where its velocity says that it was to where it is.

void FixPBDCloth::load()
{
  for (int s = 0; s < halo.n_owned(); s++) {
    const double *x = atom->x[halo.atom_of(s)], *u = atom->v[halo.atom_of(s)];
    const double back = kick[s] == 0.0 ? update->dt : 0.0;
    start[s] = {x[0] - back * u[0], x[1] - back * u[1], x[2] - back * u[2], p[s].w};
    v[s] = {u[0], u[1], u[2], p[s].w};
  }
  for (int s : attached) load_attached(s);
  halo.forward_places(ALL, start.data(), update->dt);
}

// An attached vertex starts where the solver left it and goes with its body, but for the part of
// the gap to its place there that it closes.

void FixPBDCloth::load_attached(int s)
{
  const double *gap = hold[halo.atom_of(s)] + GAP;
  start[s] = {start[s].x - gap[0], start[s].y - gap[1], start[s].z - gap[2], p[s].w};
  v[s] = velocity_of_attached(s);
}

Vertex FixPBDCloth::velocity_of_attached(int s) const
{
  const double *u = atom->v[halo.atom_of(s)], *gap = hold[halo.atom_of(s)] + GAP;
  const double by = CLOSED / update->dt;
  return {u[0] + by * gap[0], u[1] + by * gap[1], u[2] + by * gap[2], p[s].w};
}

void FixPBDCloth::substep(int n)
{
  const double dt = substep_dt();
  // from velocities at the time of the positions to those of half a step later
  const double dtf = (from_start && !started && n == 0 ? 0.5 : 1.0) * dt * force->ftm2v;
  if (damping > 0.0) damp();    // before the forces: weight is not damped
  for (int s = 0; s < halo.n_owned(); s++) {
    const double *f = atom->f[halo.atom_of(s)], by = dtf * kick[s];
    v[s].x += by * f[0];
    v[s].y += by * f[1];
    v[s].z += by * f[2];
  }
  const bool last = n == substeps - 1;
  for (int s = 0; s < halo.n_owned(); s++) {
    displacement[s] = {dt * v[s].x, dt * v[s].y, dt * v[s].z, displacement[s].w};
    if (!last || displacement[s].w > 0.0) continue;
    const double *x = atom->x[halo.atom_of(s)];    // without rounding
    displacement[s] = {x[0] - start[s].x, x[1] - start[s].y, x[2] - start[s].z, 0.0};
  }
  halo.forward_displacements(ALL, displacement.data(), substep_dt());
  for (SolverCoupling *coupling : present) coupling->begin_substep(start.data(), v.data(), dt);

  project_all(dt);
  go();
  if (hold) {
    add_pull_on_pins(constraints.distance);
    add_pull_on_pins(constraints.bending);
  }
  const double inv_dt = 1.0 / dt;
  for (int s = 0; s < halo.n_owned(); s++) {
    if (displacement[s].w == 0.0) continue;
    v[s].x = inv_dt * displacement[s].x;
    v[s].y = inv_dt * displacement[s].y;
    v[s].z = inv_dt * displacement[s].z;
  }
  for (SolverCoupling *coupling : present) coupling->end_substep(v.data(), dt);
  if (!last) start = p;
}

// where everybody is after the way so far

void FixPBDCloth::go()
{
  for (int s = 0; s < halo.n_slots(); s++) {
    p[s].x = start[s].x + displacement[s].x;
    p[s].y = start[s].y + displacement[s].y;
    p[s].z = start[s].z + displacement[s].z;
  }
}

// Takes the stretching motion out of the edges (line 29), at the rate that the user gave.

void FixPBDCloth::damp()
{
  const double share = -std::expm1(-damping * substep_dt());
  halo.forward_velocities(ALL, v.data());
  for (int c = 0; c < constraints.edge_colors(); c++) {
    sphcloth::damp(constraints.distance, c, start.data(), v.data(), share);
    halo.forward_velocities(constraints.channel_of_edge_color(c), v.data());
  }
}

void FixPBDCloth::project_all(double dt)
{
  const ClothState state{start.data(), displacement.data(), from_start,
                         solver == Solver::JACOBI ? change.data() : nullptr, 1.0 / (dt * dt)};
  std::fill(constraints.distance.lambda.begin(), constraints.distance.lambda.end(), 0.0);
  std::fill(constraints.bending.lambda.begin(), constraints.bending.lambda.end(), 0.0);
  const int n = solver == Solver::SUBSTEPS ? 1 : iterations;
  for (sweeps = 0; sweeps < n;) {
    solver == Solver::JACOBI ? jacobi(state) : gauss_seidel(state);
    for (SolverCoupling *coupling : present) {
      coupling->project(displacement.data());
      halo.forward_displacements(ALL, displacement.data(), substep_dt());
    }
    sweeps++;
    if (tolerance == 0.0) continue;
    go();
    if (converged()) break;
  }
}

// One after the other in a fixed order, a sweep pulls harder one way than the other: what it does to a
// sheet is no force with an energy.  There and back it is.

void FixPBDCloth::gauss_seidel(const ClothState &state)
{
  const int n = constraints.distance.colors() + constraints.bending.colors();
  for (int c = 0; c < n; c++) project_color(c, state);
  for (int c = n - 1; symmetric_sweeps && c >= 0; c--) project_color(c, state);
}

// edges first, then hinges

void FixPBDCloth::project_color(int c, const ClothState &state)
{
  const int hinge = c - constraints.distance.colors();
  if (hinge < 0) {
    project(constraints.distance, c, state);
    halo.forward_displacements(constraints.channel_of_edge_color(c), displacement.data(),
                               substep_dt());
  } else {
    project(constraints.bending, hinge, state);
    halo.forward_displacements(constraints.channel_of_hinge_color(hinge), displacement.data(),
                               substep_dt());
  }
}

void FixPBDCloth::jacobi(const ClothState &state)
{
  for (int c = 0; c < constraints.distance.colors(); c++) project(constraints.distance, c, state);
  for (int c = 0; c < constraints.bending.colors(); c++) project(constraints.bending, c, state);
  for (int s = 0; s < halo.n_owned(); s++) {
    displacement[s].x += change[s].x;
    displacement[s].y += change[s].y;
    displacement[s].z += change[s].z;
  }
  std::fill(change.begin(), change.end(), Vertex());
  halo.forward_displacements(ALL, displacement.data(), substep_dt());
}

// What the free vertices gained beyond the external forces came from those that are held.

void FixPBDCloth::store()
{
  Vec3 gained = Vec3::Zero(), external = Vec3::Zero(), met = Vec3::Zero();
  for (int s = 0; s < halo.n_owned(); s++) {
    const int i = halo.atom_of(s);
    if (!(atom->mask[i] & attachbit)) {
      external += Vec3(atom->f[i][0], atom->f[i][1], atom->f[i][2]);
      for (const SolverCoupling *coupling : present) {
        met += coupling->impulse_on(s);
        if (p[s].w == 0.0) push_held(i, coupling->impulse_on(s));
      }
    }
    if (kick[s] == 0.0) continue;
    const std::array<double, 3> velocity{v[s].x, v[s].y, v[s].z}, place{p[s].x, p[s].y, p[s].z};
    for (int d = 0; d < 3; d++) {
      gained[d] += (velocity[d] - atom->v[i][d]) / p[s].w;
      atom->v[i][d] = velocity[d];
      atom->x[i][d] = place[d];
    }
  }
  const Vec3 from_holders = (gained - met) / (update->dt * force->ftm2v) - external;
  if (!std::isfinite(from_holders.sum()))
    rank_error(lmp, FLERR,
               "{}: the cloth flew apart in step {}: hinges may contradict each other or have no "
               "stiff edges, or the time step is too large",
               label, update->ntimestep);
  for (int d = 0; d < 3; d++) holding[d] = from_holders[d];
}

/* ----------------------------------------------------------------------
   Substeps spread the forces of the start of a step evenly over it, so that what hangs at rest hangs
   exactly, but they come half a step, less half a substep, late.  So much is lent ahead at the start
   of each step, and what the last one has lent is taken back: that makes the step velocity Verlet,
   which feeds no motion.
------------------------------------------------------------------------- */

void FixPBDCloth::lend()
{
  const double part = 0.5 * (1.0 - 1.0 / substeps), dtf = part * update->dt * force->ftm2v;
  for (int s = 0; s < halo.n_owned(); s++) {
    const int i = halo.atom_of(s);
    const bool first = std::isnan(lent[i][0]);
    for (int d = 0; d < 3; d++) {
      const double impulse = dtf * atom->f[i][d];
      if (!first) atom->v[i][d] += kick[s] * (impulse - lent[i][d]);
      lent[i][d] = impulse;
    }
  }
}

double FixPBDCloth::all_lent(int d) const
{
  double sum = 0.0;
  for (int s = 0; lent && s < halo.n_owned(); s++)
    if (const int i = halo.atom_of(s); kick[s] > 0.0 && !std::isnan(lent[i][d])) sum += lent[i][d];
  return sum;
}

/* ----------------------------------------------------------------------
   pull of the cloth on what holds its vertices
------------------------------------------------------------------------- */

void FixPBDCloth::want_reaction_forces()
{
  if (hold) return;
  memory->create(hold, atom->nmax, HOLD, "pbd/cloth:hold");
  std::fill_n(hold[0], HOLD * atom->nmax, 0.0);
}

// A pin carries what acts on it, in addition to the pull of its constraints.

void FixPBDCloth::start_pulls()
{
  for (int s = 0; s < halo.n_owned(); s++) {
    const int i = halo.atom_of(s);
    for (int d = 0; d < 3; d++)
      if (p[s].w == 0.0) hold[i][d] = atom->f[i][d];
  }
}

template <std::size_t N> void FixPBDCloth::add_pull_on_pins(const Constraints<N> &c)
{
  const double dt = substep_dt();
  const double by = 1.0 / (dt * dt * force->ftm2v * substeps);
  for_each_held(c, p.data(), from_start ? start.data() : nullptr, [&](int s, const Vec3 &gradient) {
    if (!halo.is_ghost(s))
      for (int d = 0; d < 3; d++) hold[halo.atom_of(s)][d] += by * gradient[d];
  });
}

// An attached vertex took part with its own mass: what it gained is the body's, from now on.

void FixPBDCloth::apply_reactions()
{
  for (int s : attached) {
    const int i = halo.atom_of(s);
    const double by = 1.0 / (p[s].w * update->dt * force->ftm2v);
    const Vertex was = velocity_of_attached(s);
    const std::array<double, 6> now{by * (v[s].x - was.x),  by * (v[s].y - was.y),
                                    by * (v[s].z - was.z),  atom->x[i][0] - p[s].x,
                                    atom->x[i][1] - p[s].y, atom->x[i][2] - p[s].z};
    std::copy(now.begin(), now.end(), hold[i]);
  }
}

void FixPBDCloth::push_held(int i, const Vec3 &impulse)
{
  if (!hold) return;
  for (int d = 0; d < 3; d++) hold[i][d] += impulse[d] / (update->dt * force->ftm2v);
}

void FixPBDCloth::pre_reverse(int, int)
{
  for (int i = 0; i < atom->nlocal; i++)
    if (atom->mask[i] & groupbit && atom->mask[i] & attachbit)
      for (int d = 0; d < 3; d++) atom->f[i][d] += hold[i][d];
}

Eigen::Vector3d FixPBDCloth::reaction_force(int i) const
{
  return is_held(i) ? Vec3(-hold[i][0], -hold[i][1], -hold[i][2]) : Vec3::Zero();
}

/* ----------------------------------------------------------------------
   output: force of the holders on the cloth (x, y, z), largest edge strain, residual, sweeps,
   elastic energy, momentum that is lent ahead of time (x, y, z)
------------------------------------------------------------------------- */

double FixPBDCloth::compute_vector(int n)
{
  if (n == 5) return substeps * sweeps;
  if ((n == 4 || n == 6) && !remembered) remember();
  double mine = 0.0, all;
  if (n < 3) mine = holding[n];
  if (n == 3) mine = largest_strain();
  if (n == 4) mine = last_residual;
  if (n == 6) mine = last_energy;
  if (n > 6) mine = all_lent(n - 7);
  MPI_Allreduce(&mine, &all, 1, MPI_DOUBLE, n == 3 || n == 4 ? MPI_MAX : MPI_SUM, world);
  return all;
}

// residual and energy of the last step, once and only if they are asked for or the lists change

void FixPBDCloth::remember()
{
  remembered = true;
  last_residual = residual();
  last_energy = force->mvv2e *
      (elastic_energy(constraints.distance, p.data(), halo.n_owned()) +
       elastic_energy(constraints.bending, p.data(), halo.n_owned()));
}

double FixPBDCloth::residual() const
{
  const double dt = substep_dt(), inv_dt_sq = 1.0 / (dt * dt);
  return std::max(
      sphcloth::residual(constraints.distance, p.data(), inv_dt_sq, constraints.mean_length()),
      sphcloth::residual(constraints.bending, p.data(), inv_dt_sq));
}

bool FixPBDCloth::converged() const
{
  double mine = residual(), all;
  MPI_Allreduce(&mine, &all, 1, MPI_DOUBLE, MPI_MAX, world);
  return all < tolerance;
}

// a seam, which closes to nothing, does not count

double FixPBDCloth::shortest_edge(int i) const
{
  double shortest = std::numeric_limits<double>::infinity();
  const int vertex = mesh.index_of(atom->tag[i]);
  for (int k = mesh.edges.first[vertex]; k < mesh.edges.first[vertex + 1]; k++) {
    const double rest = rest_length(mesh.edges.incident[k]);
    if (rest > 0.0) shortest = std::min(shortest, rest);
  }
  return shortest;
}

double FixPBDCloth::largest_strain() const
{
  double strain = 0.0;
  for (int s = 0; s < halo.n_owned(); s++) {
    const int i = halo.atom_of(s), vertex = mesh.index_of(atom->tag[i]);
    for (int k = mesh.edges.first[vertex]; k < mesh.edges.first[vertex + 1]; k++) {
      const int m = mesh.edges.incident[k];
      if (!has_strain(m)) continue;
      const auto &[a, b] = mesh.edges.vertices[m];
      const int j = mesh.image_near(a == vertex ? b : a, i);
      if (j < 0 || (is_held(i) && is_held(j))) continue;
      const Vec3 edge(atom->x[i][0] - atom->x[j][0], atom->x[i][1] - atom->x[j][1],
                      atom->x[i][2] - atom->x[j][2]);
      strain = std::max(strain, std::fabs(edge.norm() / rest_length(m) - 1.0));
    }
  }
  return strain;
}

/* ----------------------------------------------------------------------
   the halo's link data
------------------------------------------------------------------------- */

int FixPBDCloth::pack_forward_comm(int n, int *sendlist, double *buf, int, int *)
{
  return halo.pack_link(n, sendlist, buf);
}

void FixPBDCloth::unpack_forward_comm(int n, int first, double *buf)
{
  halo.unpack_link(n, first, buf);
}

/* ----------------------------------------------------------------------
   rest positions, and what else is kept of a vertex, travel with it
------------------------------------------------------------------------- */

void FixPBDCloth::grow_arrays(int nmax)
{
  memory->grow(rest_x, nmax, 3, "pbd/cloth:rest");
  if (hold) memory->grow(hold, nmax, HOLD, "pbd/cloth:hold");
  if (lent) memory->grow(lent, nmax, 3, "pbd/cloth:lent");
}

void FixPBDCloth::copy_arrays(int i, int j, int)
{
  std::copy(rest_x[i], rest_x[i] + 3, rest_x[j]);
  if (hold) std::copy(hold[i], hold[i] + HOLD, hold[j]);
  if (lent) std::copy(lent[i], lent[i] + 3, lent[j]);
}

void FixPBDCloth::set_arrays(int i)
{
  std::fill(rest_x[i], rest_x[i] + 3, std::numeric_limits<double>::quiet_NaN());
  if (hold) std::fill(hold[i], hold[i] + HOLD, 0.0);
  if (lent) std::fill(lent[i], lent[i] + 3, NOT_YET);
}

int FixPBDCloth::pack_exchange(int i, double *buf)
{
  double *end = std::copy(rest_x[i], rest_x[i] + 3, buf);
  if (hold) end = std::copy(hold[i], hold[i] + HOLD, end);
  if (lent) end = std::copy(lent[i], lent[i] + 3, end);
  return static_cast<int>(end - buf);
}

int FixPBDCloth::unpack_exchange(int i, double *buf)
{
  const double *from = buf;
  const auto take = [&from](double *to, int n) {
    std::copy(from, from + n, to);
    from += n;
  };
  take(rest_x[i], 3);
  if (hold) take(hold[i], HOLD);
  if (lent) take(lent[i], 3);
  return static_cast<int>(from - buf);
}

// the first value of a restart record is its length

int FixPBDCloth::pack_restart(int i, double *buf)
{
  buf[0] = 1 + pack_exchange(i, buf + 1);
  return static_cast<int>(buf[0]);
}

// It may have been written with another solver, or without holds.

void FixPBDCloth::unpack_restart(int i, int nth)
{
  const double *record = atom->extra[i];
  for (int k = 0; k < nth; k++) record += static_cast<int>(*record);
  const int size = static_cast<int>(*record) - 1;
  const bool had_hold = size >= 3 + HOLD, had_lent = size - (had_hold ? HOLD : 0) > 3;
  const double *from = record + 1;
  std::copy(from, from + 3, rest_x[i]);
  from += 3;
  if (hold && had_hold) std::copy(from, from + HOLD, hold[i]);
  if (had_hold) from += HOLD;
  if (lent && had_lent)
    std::copy(from, from + 3, lent[i]);
  else if (lent)
    std::fill(lent[i], lent[i] + 3, NOT_YET);
}

int FixPBDCloth::size_restart(int) { return maxsize_restart(); }
int FixPBDCloth::maxsize_restart() { return 4 + (hold ? HOLD : 0) + (lent ? 3 : 0); }

struct Kept {    // without gaps
  double shortest, started;
};

void FixPBDCloth::write_restart(FILE *fp)
{
  if (comm->me) return;
  write_record(fp, Kept{shortest_of_late, started ? 1.0 : 0.0});
}

void FixPBDCloth::restart(char *buf)
{
  const Kept kept = read_record<Kept>(buf, label, error);
  keep_restored_time(update);
  shortest_of_late = kept.shortest;
  started = kept.started != 0.0;
}

double FixPBDCloth::memory_usage()
{
  return (3.0 + (hold ? HOLD : 0.0) + (lent ? 3.0 : 0.0)) * sizeof(double) * atom->nmax +
      constraints.distance.bytes() + constraints.bending.bytes() +
      bytes_of(p, v, start, displacement, change) + halo.memory_usage();
}
