// Position-based dynamics of cloth: (4) to (9) and lines 19 to 29 of Algorithm 1.
//
// Constraints are projected colour by colour (Gauss-Seidel).  The colours follow from the global
// IDs alone and every rank projects each constraint that touches one of its vertices, so that the
// result does not depend on the number of ranks; after a colour only the vertices that it moved
// are forwarded.

#include "fix_pbd_cloth.h"

#include "arg_reader.h"
#include "atom.h"
#include "atom_tools.h"
#include "bond_pbd.h"
#include "comm.h"
#include "core/colouring.h"
#include "core/constraints.h"
#include "dihedral_pbd.h"
#include "domain.h"
#include "error.h"
#include "force.h"
#include "group.h"
#include "memory.h"
#include "modify.h"
#include "update.h"

#include <algorithm>
#include <cmath>
#include <limits>

using namespace LAMMPS_NS;
using namespace FixConst;
using namespace sphcloth;

/* ----------------------------------------------------------------------
   fix ID group pbd/cloth keyword value ...
------------------------------------------------------------------------- */

FixPBDCloth::FixPBDCloth(LAMMPS *lmp, int narg, char **arg) :
    Fix(lmp, narg, arg), label(fmt::format("fix {} pbd/cloth", id)), iterations(10), pinbit(0),
    damping(0.0), rest_x(nullptr), mesh(lmp, label), halo(lmp), pin_force{}
{
  time_integrate = 1;
  restart_peratom = 1;
  create_attribute = 1;
  vector_flag = 1;
  size_vector = 4;
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

  grow_arrays(atom->nmax);
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
  while (args.more()) {
    const std::string keyword = args.word("keyword");
    if (keyword == "iterations")
      iterations = args.integer("iterations", 1, 100000);
    else if (keyword == "pin") {
      const std::string name = args.word("pin group");
      const int pins = group->find(name);
      if (pins < 0) args.fail("pin group", name, "define it with the group command first");
      pinbit = group->bitmask[pins];
      check_pins();
    } else if (keyword == "damping")
      damping = args.at_least("damping rate", 0.0);
    else if (keyword == "rest")
      take_rest_positions(args.word("rest property").c_str());
    else
      args.unknown(keyword, "iterations, pin, damping, rest");
  }
}

void FixPBDCloth::check_pins()
{
  if (!share_atoms(atom, groupbit, pinbit, world))
    error->all(
        FLERR,
        "{}: the pin group has no vertex of group {}: choose pins among the cloth's vertices "
        "or leave the pin keyword away",
        label, group->names[igroup]);
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
  for (int i = 0; i < atom->nlocal; i++)
    for (int d = 0; d < 3; d++) rest_x[i][d] = atom->darray[index][i][d];
}

FixPBDCloth::~FixPBDCloth()
{
  atom->delete_callback(id, Atom::GROW);
  atom->delete_callback(id, Atom::RESTART);
  memory->destroy(rest_x);
}

int FixPBDCloth::setmask() { return INITIAL_INTEGRATE | POST_NEIGHBOR; }

/* ----------------------------------------------------------------------
   the mesh and what follows from it
------------------------------------------------------------------------- */

void FixPBDCloth::init()
{
  check_overlap();
  mesh.gather(groupbit);
  if (!mesh.edges.size())
    error->all(FLERR, "{}: group {} has no bonds: create the cloth with create_cloth or read_data",
               label, group->names[igroup]);
  read_stiffness();
  measure_rest();
  colour_mesh();
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

void FixPBDCloth::read_stiffness()
{
  const auto *bond = dynamic_cast<BondPBD *>(force->bond ? force->bond_match("pbd") : nullptr);
  if (!bond)
    error->all(FLERR, "{}: bond_style {} holds no stiffness: use 'bond_style pbd'", label,
               force->bond_style ? force->bond_style : "none");
  edge_stiffness.assign(atom->nbondtypes + 1, -1.0);
  for (int t = 1; t <= atom->nbondtypes; t++)
    if (bond->owns(t)) edge_stiffness[t] = stiffness_per_iteration(bond->stiffness(t), iterations);

  const auto *dihedral =
      dynamic_cast<DihedralPBD *>(force->dihedral ? force->dihedral_match("pbd") : nullptr);
  hinge_stiffness.assign(atom->ndihedraltypes + 1, -1.0);
  for (int t = 1; t <= atom->ndihedraltypes; t++)
    if (dihedral && dihedral->owns(t))
      hinge_stiffness[t] = stiffness_per_iteration(dihedral->stiffness(t), iterations);
}

// Rest lengths and rest angles from the rest positions, which each vertex carries.

void FixPBDCloth::measure_rest()
{
  const int n = mesh.n_vertices();
  std::vector<Vec3> mine(n, Vec3::Zero()), rest(n);
  int missing = 0;
  for (int i = 0; i < atom->nlocal; i++) {
    if (!(atom->mask[i] & groupbit)) continue;
    if (!std::isfinite(rest_x[i][0])) missing = static_cast<int>(atom->tag[i]);
    mine[mesh.index_of(atom->tag[i])] = Vec3(rest_x[i][0], rest_x[i][1], rest_x[i][2]);
  }
  int any_missing = 0;
  MPI_Allreduce(&missing, &any_missing, 1, MPI_INT, MPI_MAX, world);
  if (any_missing)
    error->all(
        FLERR,
        "{}: vertex {} has no rest position, it was added after the fix: define the fix when "
        "the cloth is complete",
        label, any_missing);
  MPI_Allreduce(mine.data(), rest.data(), 3 * n, MPI_DOUBLE, MPI_SUM, world);

  // nearest images, for cloth that closes over a periodic boundary
  const auto from = [&](int a, int b) {
    Vec3 d = rest[b] - rest[a];
    domain->minimum_image(FLERR, d.data());
    return d;
  };
  edge_rest.resize(mesh.edges.size());
  for (std::size_t m = 0; m < mesh.edges.size(); m++) {
    const auto &[a, b] = mesh.edges.vertices[m];
    edge_rest[m] = from(a, b).norm();
  }
  hinge_rest.resize(mesh.hinges.size());
  for (std::size_t m = 0; m < mesh.hinges.size(); m++) {
    const auto &[a, e1, e2, b] = mesh.hinges.vertices[m];
    hinge_rest[m] = hinge(from(e1, a), Vec3::Zero(), from(e1, e2), from(e1, b)).angle;
  }
}

void FixPBDCloth::colour_mesh()
{
  distance.colour = colour_constraints(mesh.edges.vertices, mesh.n_vertices(), distance.n_colours);
  bending.colour = colour_constraints(mesh.hinges.vertices, mesh.n_vertices(), bending.n_colours);
}

/* ----------------------------------------------------------------------
   this rank's constraints, after each list build
------------------------------------------------------------------------- */

void FixPBDCloth::post_neighbor()
{
  std::vector<int> owned;
  for (int i = 0; i < atom->nlocal; i++)
    if (atom->mask[i] & groupbit) owned.push_back(i);
  halo.reset(1 + distance.n_colours + bending.n_colours, owned);

  collect(distance, mesh.edges, edge_rest, edge_stiffness);
  collect(bending, mesh.hinges, hinge_rest, hinge_stiffness);

  std::vector<int> vertex_of_slot(halo.n_slots());
  for (int s = 0; s < halo.n_slots(); s++)
    vertex_of_slot[s] = mesh.index_of(atom->tag[halo.atom_of(s)]);
  ask_for_ghosts(vertex_of_slot);
  halo.connect(this);

  p.resize(halo.n_slots());
  v.resize(damping > 0.0 ? halo.n_slots() : halo.n_owned());
  w.resize(halo.n_slots());
  for (int s = 0; s < halo.n_owned(); s++) w[s] = inverse_mass(halo.atom_of(s));
  halo.forward(ALL, w);
}

// Every constraint with at least one owned vertex, once: it is taken from the view of the first
// of its vertices that is owned here.  Constraints with k = 0 do nothing and are left out.

template <std::size_t N>
void FixPBDCloth::collect(Constraints<N> &c, const ClothElements<N> &elements,
                          const std::vector<double> &rest, const std::vector<double> &stiffness)
{
  struct Found {
    int colour, element;
    std::array<int, N> slots;
  };
  std::vector<Found> found;
  for (int s = 0; s < halo.n_owned(); s++) {
    const int i = halo.atom_of(s);
    const int vertex = mesh.index_of(atom->tag[i]);
    for (int k = elements.first[vertex]; k < elements.first[vertex + 1]; k++) {
      const int m = elements.incident[k];
      if (stiffness[elements.type[m]] <= 0.0) continue;
      Found f{c.colour[m], m, {}};
      int viewer = -1;
      for (std::size_t q = 0; q < N; q++) {
        f.slots[q] = slot_of_vertex(i, elements.vertices[m][q]);
        if (viewer < 0 && !halo.is_ghost(f.slots[q])) viewer = f.slots[q];
      }
      if (viewer == s) found.push_back(f);
    }
  }
  std::sort(found.begin(), found.end(), [](const Found &a, const Found &b) {
    return a.colour != b.colour ? a.colour < b.colour : a.element < b.element;
  });

  c.slots.clear();
  c.rest.clear();
  c.stiffness.clear();
  c.first.assign(c.n_colours + 1, 0);
  for (const Found &f : found) {
    c.first[f.colour + 1]++;
    c.slots.push_back(f.slots);
    c.rest.push_back(rest[f.element]);
    c.stiffness.push_back(stiffness[elements.type[f.element]]);
  }
  for (int k = 0; k < c.n_colours; k++) c.first[k + 1] += c.first[k];
}

// slot of the image of a mesh vertex that is nearest to atom i

int FixPBDCloth::slot_of_vertex(int i, int vertex)
{
  const int j = mesh.image_near(vertex, i);
  if (j < 0)
    error->one(
        FLERR,
        "{}: vertex {} is out of reach of vertex {} on this rank: raise the ghost cut-off with "
        "'comm_modify cutoff' to the size of two edges",
        label, mesh.ids[vertex], atom->tag[i]);
  return halo.slot_of(j);
}

void FixPBDCloth::ask_for_ghosts(const std::vector<int> &vertex_of_slot)
{
  for (int s = halo.n_owned(); s < halo.n_slots(); s++) {
    const int vertex = vertex_of_slot[s];
    halo.need(s, ALL);
    for (int k = mesh.edges.first[vertex]; k < mesh.edges.first[vertex + 1]; k++)
      halo.need(s, channel_of_edge_colour(distance.colour[mesh.edges.incident[k]]));
    for (int k = mesh.hinges.first[vertex]; k < mesh.hinges.first[vertex + 1]; k++)
      halo.need(s, channel_of_hinge_colour(bending.colour[mesh.hinges.incident[k]]));
  }
}

double FixPBDCloth::inverse_mass(int i) const
{
  if (atom->mask[i] & pinbit) return 0.0;
  return 1.0 / atom_mass(atom, i);
}

/* ----------------------------------------------------------------------
   one step: lines 19 to 29 of Algorithm 1
------------------------------------------------------------------------- */

void FixPBDCloth::initial_integrate(int)
{
  predict();
  project_all();
  finish();
}

void FixPBDCloth::predict()
{
  const double dt = update->dt;
  const double dtf = dt * force->ftm2v;
  for (int s = 0; s < halo.n_owned(); s++) {
    const int i = halo.atom_of(s);
    v[s] = Vec3(atom->v[i][0], atom->v[i][1], atom->v[i][2]) +
        dtf * w[s] * Vec3(atom->f[i][0], atom->f[i][1], atom->f[i][2]);
  }
  if (damping > 0.0) damp();
  for (int s = 0; s < halo.n_owned(); s++) {
    const int i = halo.atom_of(s);
    p[s] = Vec3(atom->x[i][0], atom->x[i][1], atom->x[i][2]);
    if (w[s] > 0.0) p[s] += dt * v[s];
  }
  halo.forward(ALL, p.data(), true);
}

// Takes the stretching motion out of the edges (line 29), at the rate that the user gave.

void FixPBDCloth::damp()
{
  const double share = -std::expm1(-damping * update->dt);
  for (int s = 0; s < halo.n_owned(); s++) {
    const double *x = atom->x[halo.atom_of(s)];
    p[s] = Vec3(x[0], x[1], x[2]);
  }
  halo.forward(ALL, p.data(), true);
  halo.forward(ALL, v.data(), false);
  for (int c = 0; c < distance.n_colours; c++) {
    for (int m = distance.first[c]; m < distance.first[c + 1]; m++) {
      const auto [a, b] = distance.slots[m];
      damp_edge(p[a], p[b], v[a], v[b], w[a], w[b], share);
    }
    halo.forward(channel_of_edge_colour(c), v.data(), false);
  }
}

void FixPBDCloth::project_all()
{
  for (int n = 0; n < iterations; n++) {
    for (int c = 0; c < distance.n_colours; c++) {
      for (int m = distance.first[c]; m < distance.first[c + 1]; m++) {
        const auto [a, b] = distance.slots[m];
        project_distance(p[a], p[b], w[a], w[b], distance.rest[m], distance.stiffness[m]);
      }
      halo.forward(channel_of_edge_colour(c), p.data(), true);
    }
    for (int c = 0; c < bending.n_colours; c++) {
      for (int m = bending.first[c]; m < bending.first[c + 1]; m++) {
        const auto [a, e1, e2, b] = bending.slots[m];
        project_hinge(p[a], p[e1], p[e2], p[b], {w[a], w[e1], w[e2], w[b]}, bending.rest[m],
                      bending.stiffness[m]);
      }
      halo.forward(channel_of_hinge_colour(c), p.data(), true);
    }
  }
}

// New velocities and positions.  What the vertices gained beyond the external forces came from
// the pins.

void FixPBDCloth::finish()
{
  const double inv_dt = 1.0 / update->dt;
  Vec3 gained = Vec3::Zero(), external = Vec3::Zero();
  for (int s = 0; s < halo.n_owned(); s++) {
    const int i = halo.atom_of(s);
    external += Vec3(atom->f[i][0], atom->f[i][1], atom->f[i][2]);
    if (w[s] == 0.0) continue;
    const Vec3 velocity = inv_dt * (p[s] - Vec3(atom->x[i][0], atom->x[i][1], atom->x[i][2]));
    gained += (velocity - Vec3(atom->v[i][0], atom->v[i][1], atom->v[i][2])) / w[s];
    for (int d = 0; d < 3; d++) {
      atom->v[i][d] = velocity[d];
      atom->x[i][d] = p[s][d];
    }
  }
  const Vec3 from_pins = gained * (inv_dt / force->ftm2v) - external;
  for (int d = 0; d < 3; d++) pin_force[d] = from_pins[d];
}

/* ----------------------------------------------------------------------
   output: force of the pins on the cloth (x, y, z), largest edge strain
------------------------------------------------------------------------- */

double FixPBDCloth::compute_vector(int n)
{
  double mine = n < 3 ? pin_force[n] : largest_strain(), all;
  MPI_Allreduce(&mine, &all, 1, MPI_DOUBLE, n < 3 ? MPI_SUM : MPI_MAX, world);
  return all;
}

double FixPBDCloth::largest_strain() const
{
  double strain = 0.0;
  for (std::size_t m = 0; m < distance.slots.size(); m++) {
    const auto [slot_a, slot_b] = distance.slots[m];
    if (w[slot_a] == 0.0 && w[slot_b] == 0.0) continue;    // the user holds both ends
    const double *a = atom->x[halo.atom_of(slot_a)], *b = atom->x[halo.atom_of(slot_b)];
    const double error =
        distance_error(Vec3(a[0], a[1], a[2]), Vec3(b[0], b[1], b[2]), distance.rest[m]);
    if (distance.rest[m] > 0.0) strain = std::max(strain, std::fabs(error) / distance.rest[m]);
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
   rest positions travel with their vertices
------------------------------------------------------------------------- */

void FixPBDCloth::grow_arrays(int nmax) { memory->grow(rest_x, nmax, 3, "pbd/cloth:rest"); }

void FixPBDCloth::copy_arrays(int i, int j, int) { std::copy(rest_x[i], rest_x[i] + 3, rest_x[j]); }

void FixPBDCloth::set_arrays(int i)
{
  std::fill(rest_x[i], rest_x[i] + 3, std::numeric_limits<double>::quiet_NaN());
}

int FixPBDCloth::pack_exchange(int i, double *buf)
{
  std::copy(rest_x[i], rest_x[i] + 3, buf);
  return 3;
}

int FixPBDCloth::unpack_exchange(int i, double *buf)
{
  std::copy(buf, buf + 3, rest_x[i]);
  return 3;
}

// the first value of a restart record is its length

int FixPBDCloth::pack_restart(int i, double *buf)
{
  buf[0] = 4;
  std::copy(rest_x[i], rest_x[i] + 3, buf + 1);
  return 4;
}

void FixPBDCloth::unpack_restart(int i, int nth)
{
  const double *extra = atom->extra[i];
  int m = 0;
  for (int k = 0; k < nth; k++) m += static_cast<int>(extra[m]);
  std::copy(extra + m + 1, extra + m + 4, rest_x[i]);
}

int FixPBDCloth::size_restart(int) { return 4; }
int FixPBDCloth::maxsize_restart() { return 4; }

double FixPBDCloth::memory_usage()
{
  const double constraints =
      distance.slots.capacity() * (sizeof(std::array<int, 2>) + 2 * sizeof(double)) +
      bending.slots.capacity() * (sizeof(std::array<int, 4>) + 2 * sizeof(double));
  return 3.0 * sizeof(double) * atom->nmax + constraints + 7.0 * sizeof(double) * p.capacity() +
      halo.memory_usage();
}
