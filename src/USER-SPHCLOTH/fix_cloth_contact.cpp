// Contact of particles with moving triangles, after both have moved.
//
// A contact exchanges the impulse that takes the approaching motion away, mass-weighted, between
// the particle and the three vertices; it acts on position and velocity of the same step.
// Simultaneous contacts are solved together by splitting the mass of a vertex, or of a particle,
// over its contacts, which keeps momentum and always converges: Tonge, Benevolenski & Voroshilov,
// ACM Trans. Graph. 31 (2012) 105.  Passes are repeated until no contact is left.

#include "fix_cloth_contact.h"

#include "arg_reader.h"
#include "atom.h"
#include "atom_tools.h"
#include "comm.h"
#include "domain.h"
#include "error.h"
#include "fix_pbd_cloth.h"
#include "force.h"
#include "group.h"
#include "modify.h"
#include "update.h"

#include <algorithm>
#include <cmath>

using namespace LAMMPS_NS;
using namespace FixConst;
using namespace sphcloth;

// share of the gap that the two-way passes may leave to the last ones
static constexpr double LOOSE = 1e-2;

// one-way passes are cheap, they only last long in the narrow end of a fold
static constexpr int STOP_PASSES = 10;

/* ----------------------------------------------------------------------
   fix ID group cloth/contact thickness keyword value ...
------------------------------------------------------------------------- */

FixClothContact::FixClothContact(LAMMPS *lmp, int narg, char **arg) :
    Fix(lmp, narg, arg), label(fmt::format("fix {} cloth/contact", id)), thickness(0.0),
    max_passes(20), halo(lmp), counts{}, deepest(0.0), impulse{}
{
  vector_flag = 1;
  size_vector = 7;
  global_freq = 1;
  extvector = 0;
  comm_forward = VertexHalo::LINK;
  dynamic_group_allow = 1;

  ArgReader args(lmp, label, narg, arg, 3);
  thickness = args.positive("thickness");
  while (args.more()) {
    const std::string keyword = args.word("keyword");
    if (keyword != "passes") args.unknown(keyword, "passes");
    max_passes = args.integer("passes", 1, 10000);
  }
}

int FixClothContact::setmask() { return POST_NEIGHBOR | POST_INTEGRATE; }

void FixClothContact::init()
{
  cloths.clear();
  for (Fix *fix : modify->get_fix_by_style("^pbd/cloth$")) {
    cloths.push_back(dynamic_cast<FixPBDCloth *>(fix));
    if (share_atoms(atom, groupbit, fix->groupbit, world))
      error->all(FLERR,
                 "{}: group {} holds vertices of fix {}: give the group of the particles that meet "
                 "the cloth",
                 label, group->names[igroup], fix->id);
  }
  if (cloths.empty())
    error->all(FLERR, "{}: there is no cloth: define 'fix ID group pbd/cloth' before", label);
}

/* ----------------------------------------------------------------------
   triangles with vertices in reach of this rank, after each list build
------------------------------------------------------------------------- */

// every cloth has gathered its mesh by now, whatever the order of the fixes

void FixClothContact::setup_post_neighbor()
{
  bool any_triangle = false;
  for (const FixPBDCloth *cloth : cloths)
    any_triangle = any_triangle || cloth->topology().triangles.size();
  if (!any_triangle)
    error->all(FLERR,
               "{}: the cloth has no triangles: they are LAMMPS angles, create_cloth makes them, a "
               "data file needs an Angles section",
               label);
  post_neighbor();
}

void FixClothContact::post_neighbor()
{
  std::vector<int> owned, reach;
  for (int i = 0; i < atom->nlocal + atom->nghost; i++) {
    bool vertex = false;
    for (const FixPBDCloth *cloth : cloths) vertex = vertex || atom->mask[i] & cloth->groupbit;
    if (!vertex) continue;
    reach.push_back(i);
    if (i < atom->nlocal) owned.push_back(i);
  }
  halo.reset(1, owned);
  triangles.clear();
  for (const FixPBDCloth *cloth : cloths) add_triangles(*cloth, reach);
  for (int s = halo.n_owned(); s < halo.n_slots(); s++) halo.need(s, 0);
  halo.connect(this);
  check_reach();

  w.assign(halo.n_slots(), 0.0);
  for (int s = 0; s < halo.n_owned(); s++)
    for (const FixPBDCloth *cloth : cloths)
      if (atom->mask[halo.atom_of(s)] & cloth->groupbit)
        w[s] = cloth->inverse_mass(halo.atom_of(s));
  halo.forward(0, w);
  start.resize(halo.n_slots());
  end.resize(halo.n_slots());
}

// Every image of a triangle once, from the view of its first vertex; an image with a ghost vertex
// out of reach is too far from this rank's particles to matter.

void FixClothContact::add_triangles(const FixPBDCloth &cloth, const std::vector<int> &reach)
{
  const ClothTopology &mesh = cloth.topology();
  const ClothElements<3> &t = mesh.triangles;
  for (int i : reach) {
    const int vertex = mesh.index_of(atom->tag[i]);
    if (vertex < 0) continue;
    for (int k = t.first[vertex]; k < t.first[vertex + 1]; k++) {
      const std::array<int, 3> &members = t.vertices[t.incident[k]];
      if (members[0] != vertex) continue;
      const int j = mesh.image_near(members[1], i), l = mesh.image_near(members[2], i);
      if ((j < 0 || l < 0) && i < atom->nlocal)
        error->one(
            FLERR,
            "{}: the triangle of vertices {}, {} and {} is larger than the ghost cut-off: raise "
            "it with 'comm_modify cutoff', or refine the mesh",
            label, mesh.ids[vertex], mesh.ids[members[1]], mesh.ids[members[2]]);
      if (j < 0 || l < 0) continue;
      triangles.push_back({halo.slot_of(i), halo.slot_of(j), halo.slot_of(l)});
    }
  }
}

// A particle next to a triangle must see all of its vertices, also those of other ranks.

void FixClothContact::check_reach()
{
  if (comm->nprocs == 1 && !domain->xperiodic && !domain->yperiodic && !domain->zperiodic) return;
  double longest_sq = 0.0;
  for (const std::array<int, 3> &t : triangles)
    for (int q = 0; q < 3; q++) {
      const double *a = atom->x[halo.atom_of(t[q])], *b = atom->x[halo.atom_of(t[(q + 1) % 3])];
      longest_sq =
          std::max(longest_sq, (Vec3(a[0], a[1], a[2]) - Vec3(b[0], b[1], b[2])).squaredNorm());
    }
  const double needed = std::sqrt(longest_sq) + thickness, reach = comm->get_comm_cutoff();
  if (needed > reach)
    error->one(
        FLERR,
        "{}: the longest edge of the cloth and the thickness are {}, more than the ghost cut-off "
        "{}: raise it with 'comm_modify cutoff', or refine the mesh",
        label, needed, reach);
}

/* ----------------------------------------------------------------------
   one step
------------------------------------------------------------------------- */

void FixClothContact::post_integrate()
{
  load_vertices();
  if (!find_contacts(SEAM)) return;

  // both give way, until what is left is small
  for (int pass = 0; pass < max_passes; pass++) {
    count_shares();
    resolve();
    if (!find_contacts(LOOSE)) break;
  }

  // the rest to round-off: the particle alone moves, the cloth gets the impulse
  for (int pass = 0; pass < STOP_PASSES * max_passes; pass++) {
    if (!find_contacts(SEAM)) return;
    stop_particles();
  }
  find_contacts(SEAM);
  for (const Contact &c : contacts) counts[CROSSED] += c.touch.through;
}

// Cloth and particles moved on straight lines with the velocities that they have now.

void FixClothContact::load_vertices()
{
  const double dt = update->dt;
  for (int s = 0; s < halo.n_owned(); s++) {
    const double *x = atom->x[halo.atom_of(s)], *v = atom->v[halo.atom_of(s)];
    end[s] = Vec3(x[0], x[1], x[2]);
    start[s] = end[s] - dt * Vec3(v[0], v[1], v[2]);
  }
  halo.forward(0, start.data(), true);
  halo.forward(0, end.data(), true);
}

Sweep FixClothContact::particle_sweep(int i) const
{
  const double *x = atom->x[i], *v = atom->v[i];
  const Vec3 end_i(x[0], x[1], x[2]);
  return {end_i - update->dt * Vec3(v[0], v[1], v[2]), end_i};
}

std::array<Sweep, 3> FixClothContact::triangle_sweep(int t) const
{
  std::array<Sweep, 3> sweep;
  for (int q = 0; q < 3; q++) sweep[q] = {start[triangles[t][q]], end[triangles[t][q]]};
  return sweep;
}

// collective: true if there is a contact on any rank

bool FixClothContact::find_contacts(double slack)
{
  contacts.clear();
  const Vec3 margin = Vec3::Constant(thickness);
  boxes.resize(triangles.size());
  for (std::size_t t = 0; t < triangles.size(); t++) {
    boxes[t].setEmpty();
    for (int s : triangles[t]) {
      boxes[t].extend(start[s]);
      boxes[t].extend(end[s]);
    }
    boxes[t].min() -= margin;
    boxes[t].max() += margin;
  }
  grid.build(boxes);

  const Box &cloth_box = grid.bounds();
  for (int i = 0; i < atom->nlocal; i++) {
    if (!(atom->mask[i] & groupbit)) continue;
    const Sweep particle = particle_sweep(i);
    Box box(particle.start);
    box.extend(particle.end);
    if (!cloth_box.intersects(box)) continue;
    grid.query(box, [&](int t) {
      if (!boxes[t].intersects(box)) return;
      const Touch touched = touch(particle, triangle_sweep(t), thickness, slack);
      if (touched.hit) contacts.push_back({i, t, touched});
    });
  }
  int mine = !contacts.empty(), any = 0;
  MPI_Allreduce(&mine, &any, 1, MPI_INT, MPI_MAX, world);
  return any;
}

double FixClothContact::particle_inverse_mass(int i) const { return 1.0 / atom_mass(atom, i); }

// over how many contacts the mass of each vertex and of each particle is split

void FixClothContact::count_shares()
{
  particle_share.assign(atom->nlocal, 0);
  share.assign(halo.n_slots(), Vec3::Zero());
  for (const Contact &c : contacts) {
    particle_share[c.particle]++;
    for (int s : triangles[c.triangle]) share[s][0] += 1.0;
  }
  halo.reverse_add(0, share.data());
  halo.forward(0, share.data(), false);
}

void FixClothContact::resolve()
{
  const double dt = update->dt;
  change.assign(halo.n_slots(), Vec3::Zero());
  for (const Contact &c : contacts) {
    const Touch &touched = c.touch;
    const std::array<int, 3> &slots = triangles[c.triangle];
    const double w_particle = particle_inverse_mass(c.particle);
    double split = w_particle * particle_share[c.particle];
    for (int q = 0; q < 3; q++)
      split += w[slots[q]] * share[slots[q]][0] * touched.weight[q] * touched.weight[q];
    // a hair more than needed, so that the next pass finds it done
    const double need = touched.depth + 1e-6 * touched.kept;
    const Vec3 push = (need / (dt * split)) * touched.normal;

    for (int d = 0; d < 3; d++) {
      atom->v[c.particle][d] += w_particle * push[d];
      atom->x[c.particle][d] += dt * w_particle * push[d];
    }
    push_vertices(c, push);
    counts[CONTACTS]++;
    deepest = std::max(deepest, touched.depth);
  }
  change_velocities();
  move_vertices();
}

// `change` holds what every rank found for its slots

void FixClothContact::change_velocities()
{
  halo.reverse_add(0, change.data());
  for (int s = 0; s < halo.n_owned(); s++)
    for (int d = 0; d < 3; d++) atom->v[halo.atom_of(s)][d] += change[s][d];
}

void FixClothContact::move_vertices()
{
  for (int s = 0; s < halo.n_owned(); s++) {
    const Vec3 step = update->dt * change[s];
    end[s] += step;
    for (int d = 0; d < 3; d++) atom->x[halo.atom_of(s)][d] += step[d];
  }
  halo.forward(0, end.data(), true);
}

// The particle rides along with the triangle, at the gap that it is to keep.  The impulse goes to
// the vertices and moves them from the next step on.

void FixClothContact::stop_particles()
{
  const double dt = update->dt;
  change.assign(halo.n_slots(), Vec3::Zero());
  for (const Contact &c : contacts) {
    const Vec3 dv = (c.touch.depth + 1e-6 * c.touch.kept) / dt * c.touch.normal;
    for (int d = 0; d < 3; d++) {
      atom->v[c.particle][d] += dv[d];
      atom->x[c.particle][d] += dt * dv[d];
    }
    push_vertices(c, dv / particle_inverse_mass(c.particle));
    counts[STOPS]++;
  }
  change_velocities();
}

// the opposite of the particle's impulse on the three vertices; what pinned ones get is booked

void FixClothContact::push_vertices(const Contact &c, const Vec3 &particle_impulse)
{
  for (int q = 0; q < 3; q++) {
    const int s = triangles[c.triangle][q];
    const Vec3 part = -c.touch.weight[q] * particle_impulse;
    change[s] += w[s] * part;
    if (w[s] == 0.0)
      for (int d = 0; d < 3; d++) impulse[d] += part[d] / force->ftm2v;
  }
}

/* ----------------------------------------------------------------------
   output: contacts, stops, crossed, deepest, impulse on pinned vertices (x, y, z)
------------------------------------------------------------------------- */

double FixClothContact::compute_vector(int n)
{
  double mine = n < N_COUNTS ? counts[n] : n == N_COUNTS ? deepest : impulse[n - N_COUNTS - 1];
  double all;
  MPI_Allreduce(&mine, &all, 1, MPI_DOUBLE, n == N_COUNTS ? MPI_MAX : MPI_SUM, world);
  return all;
}

int FixClothContact::pack_forward_comm(int n, int *sendlist, double *buf, int, int *)
{
  return halo.pack_link(n, sendlist, buf);
}

void FixClothContact::unpack_forward_comm(int n, int first, double *buf)
{
  halo.unpack_link(n, first, buf);
}

double FixClothContact::memory_usage()
{
  return halo.memory_usage() + static_cast<double>(sizeof(Vec3) * 4 * w.capacity()) +
      static_cast<double>(sizeof(Box) * boxes.capacity());
}
