// SPDX-License-Identifier: GPL-2.0-or-later
// Plane walls as half-spaces of fluid at rest density, core/sph/plane_wall.h.  pair_style sph/tait
// calls this fix while it evaluates, since densities must be complete before the equation of state.

#include "fix_wall_sph.h"

#include "atom.h"
#include "comm.h"
#include "domain.h"
#include "error.h"
#include "fluid/fluid_state.h"
#include "force.h"
#include "lammps_util/arg_reader.h"
#include "lammps_util/atom_tools.h"
#include "lammps_util/rank_error.h"
#include "lammps_util/restart_record.h"
#include "modify.h"
#include "update.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

using namespace LAMMPS_NS;
using namespace FixConst;
using namespace sphcloth;

static constexpr const char *FACES[6] = {"xlo", "xhi", "ylo", "yhi", "zlo", "zhi"};

static int face_of(const std::string &name)
{
  return static_cast<int>(std::find(FACES, FACES + 6, name) - FACES);
}

/* ----------------------------------------------------------------------
   fix ID group wall/sph face position ... keyword values ...
------------------------------------------------------------------------- */

FixWallSPH::FixWallSPH(LAMMPS *lmp_, int narg, char **arg) :
    Fix(lmp_, narg, arg), label(fmt::format("fix {} wall/sph", id)), fluid(nullptr), slip(false),
    any_moves(false), reflection(1.0), summed(false)
{
  for (int k = 1; k < narg; k++) words_hash = hash_with(words_hash, std::string_view(arg[k]));
  ArgReader args(lmp, label, narg, arg, 3);
  read_walls(args);
  while (args.more()) {
    const std::string keyword = args.word("keyword");
    if (keyword == "slip")
      slip = args.choice(keyword, {"yes", "no"}) == 0;
    else if (keyword == "pressure")
      reflection = args.choice(keyword, {"own", "mirror"}) ? 2.0 : 1.0;
    else if (keyword == "velocity")
      read_velocity(args);
    else
      args.unknown(keyword,
                   "xlo, xhi, ylo, yhi, zlo, zhi before the keywords slip, pressure, velocity");
  }

  restart_global =
      std::any_of(walls.begin(), walls.end(), [](const Wall &w) { return !w.has_place(); });
  for (Wall &wall : walls) positions.push_back(&wall.given);
  scalar_flag = vector_flag = 1;
  size_vector = 3 * static_cast<int>(walls.size());
  global_freq = 1;
  extscalar = extvector = 1;
  energy_global_flag = virial_global_flag = virial_peratom_flag = 1;
  dynamic_group_allow = 1;
  mine.assign(size_vector + 1, 0.0);
  all = mine;
}

void FixWallSPH::read_walls(ArgReader &args)
{
  while (args.more() && face_of(args.peek()) < 6) {
    Wall wall = {};
    const std::string name = args.word("face");
    wall.face = face_of(name);
    for (const Wall &other : walls)
      if (other.face == wall.face) args.fail("face", name, "give each face once");
    if (domain->dimension == 2 && wall.axis() == 2)
      args.fail("face", name, "a 2-D simulation has walls in x and y only");
    const std::string position = fmt::format("position of {}", name);
    if (!args.more()) args.word(position);
    if (args.peek() == std::string("EDGE")) {
      wall.at_edge = true;
      args.word(position);
    } else
      wall.given.read(args, position);
    wall.position = wall.given.value();
    if (wall.has_place()) wall.last_position = wall.position;
    walls.push_back(wall);
  }
  if (walls.empty()) {
    const std::string name = args.word("face");
    args.fail("face", name, "use one of xlo, xhi, ylo, yhi, zlo, zhi");
  }
}

void FixWallSPH::read_velocity(ArgReader &args)
{
  const std::string name = args.word("face of the velocity");
  const auto wall = std::find_if(walls.begin(), walls.end(),
                                 [&](const Wall &w) { return w.face == face_of(name); });
  if (wall == walls.end()) args.fail("face of the velocity", name, "give a face with a wall");
  for (double &part : wall->velocity) part = args.number(fmt::format("velocity of {}", name));
  if (wall->velocity[wall->axis()] != 0.0)
    args.fail(fmt::format("velocity of {} across the wall", name),
              std::to_string(wall->velocity[wall->axis()]),
              "give 0, and move the wall with a variable as its position");
  if (domain->dimension == 2 && wall->velocity[2] != 0.0)
    args.fail(fmt::format("velocity of {} in z", name), std::to_string(wall->velocity[2]),
              "give 0 in a 2-D simulation");
}

int FixWallSPH::setmask() { return POST_FORCE; }

void FixWallSPH::init()
{
  fluid = FluidState::find(force);
  if (!fluid)
    error->all(FLERR,
               "{}: pair_style {} has no density that a wall could add to: use 'pair_style "
               "sph/tait'",
               label, force->pair_style ? force->pair_style : "none");
  if (modify->get_fix_by_style("^wall/sph$").size() > 1)
    error->all(FLERR, "{}: there is another fix wall/sph: give all faces to one", label);
  table = fluid->wall_table();
  impact = fluid->wall_impact();
  profiles = fluid->lattices.wall_profiles(table, reflection);
  take_materials();
  found_at.clear();
  for (Wall &wall : walls) {
    check_face(wall);
    wall.given.check(lmp, label);
  }
}

// The box must look the same from everywhere along the wall.

void FixWallSPH::check_face(const Wall &wall) const
{
  const int axis = wall.axis();
  if (domain->periodicity[axis])
    error->all(FLERR, "{}: {} is a wall across a periodic dimension: use 'boundary f' there", label,
               FACES[wall.face]);
  if (wall.at_edge && domain->boundary[axis][wall.face % 2] != 1)
    error->all(FLERR,
               "{}: position of {} is 'EDGE', which follows the particles at a shrink-wrapped "
               "face: use 'boundary f' there, or a number",
               label, FACES[wall.face]);
  const bool tilted = domain->triclinic &&
      ((axis == 0 && (domain->xy != 0.0 || domain->xz != 0.0)) || (axis == 1 && domain->yz != 0.0));
  if (tilted)
    error->all(FLERR,
               "{}: the face of the box at {} is tilted: a wall must be parallel to its face, set "
               "the tilt of that face to 0",
               label, FACES[wall.face]);
}

/* ----------------------------------------------------------------------
   one evaluation
------------------------------------------------------------------------- */

void FixWallSPH::begin()
{
  // the time may be reset between runs
  const double elapsed = update->setupflag ? 0.0 : update->dt;
  NumberOrVariable::evaluate(lmp, label, igroup, {positions.data(), positions.size()});
  for (Wall &wall : walls) locate(wall, elapsed);
  any_moves = std::any_of(walls.begin(), walls.end(), [](const Wall &w) { return w.moves(); });
  take_materials();
  find_open_space();
  std::fill(mine.begin(), mine.end(), 0.0);
  presses.clear();
  found.clear();
  found_at.assign(atom->nlocal, {0, -1});
  summed = false;
}

void FixWallSPH::take_materials()
{
  types.assign(atom->ntypes + 1, OfType());
  for (int t = 1; t <= atom->ntypes; t++) {
    if (!fluid->is_fluid(t)) continue;
    const Tait &eos = fluid->equation_of_state(t);
    types[t] = {fluid->support(t), eos.rho0, eos.k, slip ? 0.0 : fluid->type(t).nu,
                fluid->alpha(t, t) * eos.sound_speed() * eos.rho0};
  }
}

// the space out of reach of each wall, so that most particles need no distances

void FixWallSPH::find_open_space()
{
  double longest = 0.0;
  for (const OfType &type : types) longest = std::max(longest, type.support);
  wall_at.fill(-1);
  open_low.fill(-std::numeric_limits<double>::max());
  open_high.fill(std::numeric_limits<double>::max());
  for (int k = 0; k < static_cast<int>(walls.size()); k++) {
    const Wall &wall = walls[k];
    wall_at[wall.face] = k;
    if (wall.face % 2 == 0)
      open_low[wall.axis()] = wall.position + longest;
    else
      open_high[wall.axis()] = wall.position - longest;
  }
}

// A moving plane has the velocity of its last step.  Between runs it may have been moved, too.

void FixWallSPH::locate(Wall &wall, double elapsed)
{
  const double before = wall.position;
  if (wall.at_edge)
    wall.position = wall.face % 2 == 0 ? domain->boxlo[wall.axis()] : domain->boxhi[wall.axis()];
  else if (wall.given.is_variable())
    wall.position = wall.given.value();
  else
    return;
  if (elapsed > 0.0) {
    wall.last_position = before;
    wall.velocity[wall.axis()] = (wall.position - before) / elapsed;
  } else if (!wall.last_position)
    wall.last_position = wall.position;
}

// false if no wall is in reach of particle i; otherwise `near` has those that are

bool FixWallSPH::query(int i)
{
  if (i >= static_cast<int>(found_at.size())) return measure(i, 0.0);
  Range &range = found_at[i];
  if (range.n < 0) {
    range.first = static_cast<int>(found.size());
    measure(i, 0.0, found);
    range.n = static_cast<int>(found.size()) - range.first;
  }
  if (range.n == 0) return false;
  near = {&found[range.first], static_cast<std::size_t>(range.n), profiles[atom->type[i]]};
  return true;
}

// with the walls where they are, and the particle where it was a time `back` ago

bool FixWallSPH::measure(int i, double back)
{
  measured.clear();
  measure(i, back, measured);
  near = {measured.data(), measured.size(), profiles[atom->type[i]]};
  return !measured.empty();
}

void FixWallSPH::measure(int i, double back, std::vector<NearWall> &into) const
{
  if (!(atom->mask[i] & groupbit)) return;
  const double *x = atom->x[i];
  const int type = atom->type[i];
  const auto measure_face = [&](int face) {
    const int k = wall_at[face];
    if (k < 0) return;
    double distance = walls[k].distance(x);
    if (back != 0.0) distance -= back * departure(i, k);
    const double delta = distance / types[type].support;
    if (delta < -1.0)
      rank_error(lmp, FLERR,
                 "{}: particle {} is behind the wall {}, deeper than the support of the kernel: "
                 "start it in front, or lower the time step",
                 label, atom->tag[i], FACES[face]);
    if (delta < 1.0) into.emplace_back(k, delta, table, profiles[type]);
  };
  for (int d = 0; d < 3; d++) {
    if (back != 0.0 || !(x[d] > open_low[d])) measure_face(2 * d);
    if (back != 0.0 || !(x[d] < open_high[d])) measure_face(2 * d + 1);
  }
}

double FixWallSPH::density(int i, double of_particles)
{
  if (!query(i)) return of_particles;
  return of_particles + types[atom->type[i]].rho0 * near.lambda();
}

double FixWallSPH::density_rate(int i, double of_particles, double back)
{
  if (!measure(i, back)) return of_particles;
  double rate = 0.0;
  for (std::size_t n = 0; n < near.size(); n++) rate += slope(i, n) * departure(i, near[n].wall);
  return of_particles + rate;
}

// The pressure is the gradient of the fluid's energy with the density sum that the walls take part
// in, as for boundary particles; behind a wall a spring as stiff as the fluid is added.

void FixWallSPH::prolong(double times)
{
  for (std::size_t k = 0; k + 1 < mine.size(); k++) mine[k] *= times;    // the energy stays
}

void FixWallSPH::push(int i, double p_over_rho2, double times, bool first)
{
  if (!query(i)) return;
  const OfType &type = types[atom->type[i]];
  const double support = type.support;
  const double mass = atom_mass(atom, i), to_force = mass / force->ftm2v;
  const double *v = atom->v[i];

  for (std::size_t n = 0; n < near.size(); n++) {
    const int k = near[n].wall;
    const Wall &wall = walls[k];
    const int axis = wall.axis();
    const double delta = near[n].delta, share = near.half_space_share(n), denser = slope(i, n);
    const double strain = stop_strain(delta);
    const double stop = type.stiffness * strain / (STOPPING_DEPTH * support);
    const double friction = type.nu > 0.0 ? type.nu * share * 2.0 * type.rho0 / atom->rho[i] *
            wall_friction(near[n].half_space, delta, support)
                                          : 0.0;

    // per mass, away from the wall
    const double speed = departure(i, k);
    const double slowing = speed < 0.0 ? -speed * share * impact_rate(i, impact(delta)) : 0.0;
    const double pressure = times * (stop + slowing) - reflection * p_over_rho2 * denser;
    const auto push_along = [&](int d, double accel) {
      atom->f[i][d] += to_force * accel;
      mine[3 * k + d] -= to_force * accel;
    };
    push_along(axis, wall.inwards() * pressure);
    if (friction > 0.0)
      for (const int d : {(axis + 1) % 3, (axis + 2) % 3})
        push_along(d, -times * friction * (v[d] - wall.velocity[d]));
    if (!first) continue;
    atom->drho[i] += denser * speed;
    if (thermo_virial) presses.push_back({i, axis, to_force * pressure * delta * support});
    mine.back() += 0.5 * mass * type.stiffness * strain * strain * force->mvv2e;
  }
}

void FixWallSPH::complete_gradient(int i, double *gradient)
{
  if (!query(i)) return;
  for (std::size_t n = 0; n < near.size(); n++) {
    const Wall &wall = walls[near[n].wall];
    gradient[wall.axis()] += lacking(i) * wall.inwards() * slope(i, n);
  }
}

// by the change of that gradient with the position

void FixWallSPH::push_turn(int i, const Eigen::Vector3d &turn)
{
  if (!query(i)) return;
  const OfType &type = types[atom->type[i]];
  const double to_force = atom_mass(atom, i) / force->ftm2v, support = type.support;
  const double scale = -reflection * lacking(i) * type.rho0 / (support * support);
  for (std::size_t n = 0; n < near.size(); n++) {
    const int k = near[n].wall, axis = walls[k].axis();
    double away = 0.0;
    for (std::size_t m = 0; m < near.size(); m++) {
      const Wall &other = walls[near[m].wall];
      away += scale * near.curvature(n, m) * other.inwards() * turn[other.axis()];
    }
    atom->f[i][axis] += to_force * walls[k].inwards() * away;
    mine[3 * k + axis] -= to_force * walls[k].inwards() * away;
    if (thermo_virial) presses.push_back({i, axis, to_force * away * near[n].delta * support});
  }
}

double FixWallSPH::approach(int i)
{
  if (!query(i)) return 0.0;
  double fastest = 0.0;
  for (std::size_t n = 0; n < near.size(); n++)
    fastest = std::max(fastest, -departure(i, near[n].wall));
  return fastest;
}

// where it is or where it has been

bool FixWallSPH::moves_beside(int i)
{
  if (!any_moves || !(atom->mask[i] & groupbit)) return false;
  const double *x = atom->x[i], support = types[atom->type[i]].support;
  return std::any_of(walls.begin(), walls.end(), [&](const Wall &wall) {
    return wall.moves() && std::min(wall.distance(x), wall.last_distance(x)) < support;
  });
}

// Behind a wall the spring adds the square of its own frequency along the axis of the wall.

void FixWallSPH::add_stiffness(int i, Stiffness &s)
{
  if (!query(i)) return;
  const int t = atom->type[i];
  const OfType &type = types[t];
  const Tait &eos = fluid->equation_of_state(t);
  const double support = type.support, rho = atom->rho[i];
  for (std::size_t n = 0; n < near.size(); n++) {
    const Wall &wall = walls[near[n].wall];
    const double delta = near[n].delta, share = near.half_space_share(n);
    s.gradient[wall.axis()] += std::sqrt(reflection) * wall.inwards() * slope(i, n);
    if (profiles[t].changes()) {
      // what pressure on a curved function adds, in the units of the others
      const double sound = eos.sound_speed(rho), bend = near.curvature(n) / (support * support);
      s.spring[wall.axis()] +=
          std::max(0.0, reflection * fluid->acting_pressure(eos, rho) * type.rho0 * bend) /
          (atom_mass(atom, i) * sound * sound * fluid->lattices.slope_of(t, rho));
    }
    if (delta < 0.0) {
      const double of_spring = rho / (STOPPING_DEPTH * support);
      s.spring[wall.axis()] += of_spring * of_spring / atom_mass(atom, i);
    }
    s.friction += type.nu * share * 2.0 * type.rho0 / rho *
            wall_friction(near[n].half_space, delta, support) +
        share * impact_rate(i, impact(delta));
  }
}

void FixWallSPH::add_to(ConcentrationGradient &concentration, int i)
{
  if (!query(i)) return;
  const double support = types[atom->type[i]].support;
  const int dim = domain->dimension;
  concentration.cover += near.half_spaces_lambda();
  for (std::size_t n = 0; n < near.size(); n++) {
    const Wall &wall = walls[near[n].wall];
    const WallTable::Value &half_space = near[n].half_space;
    const double share = near.half_space_share(n);
    concentration.gradient[wall.axis()] += wall.inwards() * share * half_space.slope / support;
    concentration.cover += share * (wall_cover(half_space, near[n].delta, dim) - half_space.lambda);
  }
}

// LAMMPS asks fixes for their virial here; fluid and plane count as a pair of particles.

void FixWallSPH::post_force(int vflag)
{
  v_init(vflag);
  if (!evflag) return;
  for (const Press &p : presses) v_tally(p.axis, p.particle, p.virial);
}

/* ----------------------------------------------------------------------
   output: energy of what is behind the walls; force on each wall, x, y, z
------------------------------------------------------------------------- */

double FixWallSPH::output(int n)
{
  if (!summed)
    MPI_Allreduce(mine.data(), all.data(), static_cast<int>(mine.size()), MPI_DOUBLE, MPI_SUM,
                  world);
  summed = true;
  return all[n];
}

double FixWallSPH::compute_scalar() { return output(size_vector); }

double FixWallSPH::compute_vector(int n) { return output(n); }

void *FixWallSPH::extract(const char *name, int &)
{
  return std::strcmp(name, EXTRACT) == 0 ? static_cast<FluidBoundary *>(this) : nullptr;
}

/* ----------------------------------------------------------------------
   restart: velocities of walls that move, which are those of the last step, and where they were
   before it
------------------------------------------------------------------------- */

struct FixWallSPH::Record {
  double velocity[6], last_position[6];    // across each face
};

void FixWallSPH::write_restart(FILE *fp)
{
  if (comm->me) return;
  Record record{};
  for (const Wall &wall : walls) {
    record.velocity[wall.face] = wall.velocity[wall.axis()];
    record.last_position[wall.face] = wall.last_position.value_or(wall.position);
  }
  write_record(fp, record);
}

void FixWallSPH::restart(char *buf)
{
  const auto record = read_record<Record>(buf, label, error);
  for (Wall &wall : walls) {
    if (wall.has_place()) continue;
    wall.velocity[wall.axis()] = record.velocity[wall.face];
    wall.last_position = record.last_position[wall.face];
  }
}
