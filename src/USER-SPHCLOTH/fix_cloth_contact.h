// SPDX-License-Identifier: GPL-2.0-or-later
// fix cloth/contact: particles do not pass through cloth.

#ifdef FIX_CLASS
// clang-format off
FixStyle(cloth/contact,FixClothContact);
// clang-format on
#else

#ifndef LMP_FIX_CLOTH_CONTACT_H
#define LMP_FIX_CLOTH_CONTACT_H

#include "fix.h"

#include "atom.h"
#include "contact/contact_options.h"
#include "contact/contact_surface.h"
#include "contact/joined_contact.h"
#include "contact/obstacle.h"
#include "contact/obstacle_impulses.h"
#include "fluid/mesh_boundary.h"
#include "fluid/side_source.h"
#include "lammps_util/box_faces.h"
#include "lammps_util/ghost_reach.h"
#include "lammps_util/particle_columns.h"
#include "neighbor.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

namespace LAMMPS_NS {

class FixPBDCloth;
class FixSPHIntegrate;

class FixClothContact : public Fix, public SideSource {
 public:
  FixClothContact(class LAMMPS *, int, char **);
  ~FixClothContact() override;
  int setmask() override;
  void init() override;
  void initial_integrate(int) override;
  void pre_exchange() override;
  void min_pre_exchange() override { pre_exchange(); }
  void setup_pre_neighbor() override
  {
    for (MeshContact *contact : contacts) contact->untangle();
  }
  void setup_post_neighbor() override;
  void post_neighbor() override;
  void min_post_neighbor() override { post_neighbor(); }
  void post_integrate() override;
  void post_force(int) override;
  double compute_vector(int) override;
  void setup_pre_reverse(int eflag, int vflag) override { pre_reverse(eflag, vflag); }
  void pre_reverse(int, int) override;
  int pack_forward_comm(int, int *, double *, int, int *) override;
  void unpack_forward_comm(int, int, double *) override;
  void grow_arrays(int nmax) override
  {
    for (ParticleColumns *each : columns()) each->grow(nmax);
  }
  void copy_arrays(int i, int j, int) override
  {
    for (ParticleColumns *each : columns()) each->copy(i, j);
  }
  void set_arrays(int) override;
  int pack_exchange(int, double *) override;
  int unpack_exchange(int, double *) override;
  int pack_restart(int, double *) override;
  void unpack_restart(int, int) override;
  int size_restart(int) override { return 1 + impulses.count(); }
  int maxsize_restart() override { return 1 + impulses.count(); }
  double memory_usage() override;

  // 1: the owned atom is above a sheet that is near, -1: below, 0: none is near
  int side_of(int i) const
  {
    if (!rules.sides || static_cast<std::size_t>(i) >= side.size() || side[i] == 0) return 0;
    for (int sheet = 0; sheet < sphcloth::MAX_SHEETS; sheet++)
      for (int sign : {1, -1})
        if (side[i] & sphcloth::side_of_sheet(sheet, sign > 0)) return sign;
    return 0;
  }
  // of all atoms, ghosts too, since the last list build
  const sphcloth::Sides *sides() const override { return side.data(); }
  sphcloth::Parting *layers() override { return sheet_layers.any() ? &sheet_layers : nullptr; }
  // the boundary that it is to fluid, and the sides on which fluid is
  void *extract(const char *name, int &) override
  {
    const std::string what = name;
    if (what == FluidBoundary::EXTRACT) return static_cast<FluidBoundary *>(walls.get());
    if (what == SideSource::EXTRACT && rules.sides) return static_cast<SideSource *>(this);
    return nullptr;
  }
  // From init() of a fix that is defined after this one: triangles of these types let particles of
  // these groups through, which see them from this distance.  Returns the meshes that have any.
  std::vector<MovingTriangles *> let_through(int first_type, int last_type, int bits,
                                             double distance)
  {
    std::vector<MovingTriangles *> found;
    for_all_surfaces([&](ContactSurface &surface) {
      if (surface.triangles.let_through(first_type, last_type, bits))
        found.push_back(&surface.triangles);
    });
    if (found.empty()) return found;
    if (joined) joined->triangles.let_through(first_type, last_type, bits);
    pore_distance = std::max(pore_distance, distance + neighbor->skin);
    require_ghosts();
    return found;
  }
  // the cutoff of pair_style sph/tait
  void set_view_distance(double distance) override { view_distance = distance; }

 private:
  std::string label;
  ContactOptions options;
  const ContactRules &rules;    // of particles
  GhostReach ghosts;
  ContactCounts counts;    // of this rank, since the fix was made
  StepStart step_start;
  // velocity minus displacement over the step, if densities follow displacements
  ParticleColumns excess_velocities;
  ObstacleImpulses impulses;    // if there are obstacles
  FixSPHIntegrate *stepping = nullptr;    // null: nothing sleeps
  std::vector<FixPBDCloth *> cloths;    // those before this fix
  std::vector<FixClothContact *> together;    // those of the same cloths, this one too, in order
  std::vector<std::unique_ptr<ContactSurface>> surfaces;    // one per cloth
  std::vector<std::unique_ptr<Obstacle>> obstacles;
  std::vector<std::unique_ptr<ContactSurface>> obstacle_surfaces;    // one per obstacle
  // with each of them, or with all as one mesh, if several meet
  std::vector<std::unique_ptr<MeshContact>> separate;
  std::unique_ptr<JoinedContact> joined;
  std::vector<MeshContact *> contacts;    // one or the other
  std::vector<ContactSurface *> sheets;    // those that part the fluid: cloths and open obstacles
  std::unique_ptr<MeshBoundary> walls;
  std::vector<sphcloth::Sides> side;
  sphcloth::SheetLayers sheet_layers;
  double view_distance, pore_distance = 0.0;
  bool in_layers = false;    // has any sheet been found so, on any rank?
  int vertex_bits, particle_bits;    // group bits of the cloths and of the particles

  std::array<ParticleColumns *, 3> columns()
  {
    return {&step_start.positions, &impulses, &excess_velocities};
  }
  double reach_of_triangles() const
  {
    return std::max({rules.thickness, walls ? walls->reach() : 0.0, pore_distance});
  }
  void require_ghosts();
  std::array<double, 2> ghosts_needed_and_wanted();
  // A particle must see the whole of the nearest triangle, if a neighbor may be on its other side;
  // and where sheets lie in layers, all that may be between the two.
  double ghosts_of_sides()
  {
    if (!rules.sides || view_distance == 0.0) return 0.0;
    double longest = 0.0;
    for (const ContactSurface *sheet : find_sheets())
      longest = std::max(longest, sheet->triangles.mesh->topology().longest_edge());
    if (in_layers) return longest + std::max(0.0, view_distance - rules.thickness);
    return std::hypot(longest, std::max(0.0, view_distance - neighbor->skin - rules.thickness));
  }
  // those that have two sides
  std::vector<ContactSurface *> find_sheets()
  {
    std::vector<ContactSurface *> found;
    for (auto &surface : surfaces) found.push_back(surface.get());
    for (auto &surface : obstacle_surfaces)
      if (surface->triangles.is_open()) found.push_back(surface.get());
    return found;
  }
  void subtract_excess_velocities();
  void end_step(bool any_contact);
  void find_sides();
  void check_group();
  void make_contacts();
  void join();
  MeetingRules meeting_rules() const
  {
    return {options.cloth_rules, rules, options.cloth_meets_cloth};
  }
  bool meets_cloth() const { return joined || (options.cloth_meets_cloth && !surfaces.empty()); }
  std::unique_ptr<ContactSurface> make_surface(ContactMesh *mesh)
  {
    return std::make_unique<ContactSurface>(lmp, mesh, label, particle_bits, rules, counts,
                                            step_start);
  }
  void add_obstacle(int group);
  template <class Do> void for_all_surfaces(Do something)
  {
    for (auto &surface : surfaces) something(*surface);
    for (auto &surface : obstacle_surfaces) something(*surface);
  }
};

}    // namespace LAMMPS_NS

#endif
#endif
