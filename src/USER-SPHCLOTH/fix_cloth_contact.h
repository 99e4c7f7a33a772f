// fix cloth/contact: particles do not pass through cloth.

#ifdef FIX_CLASS
// clang-format off
FixStyle(cloth/contact,FixClothContact);
// clang-format on
#else

#ifndef LMP_FIX_CLOTH_CONTACT_H
#define LMP_FIX_CLOTH_CONTACT_H

#include "fix.h"

#include "contact_surface.h"

#include <memory>
#include <string>
#include <vector>

namespace LAMMPS_NS {

class FixClothContact : public Fix {
 public:
  FixClothContact(class LAMMPS *, int, char **);
  ~FixClothContact() override;
  int setmask() override;
  void init() override;
  void setup_post_neighbor() override;
  void post_neighbor() override;
  void post_integrate() override;
  void post_force(int) override;
  double compute_vector(int) override;
  int pack_forward_comm(int, int *, double *, int, int *) override;
  void unpack_forward_comm(int, int, double *) override;
  void grow_arrays(int) override;
  void copy_arrays(int, int, int) override;
  void set_arrays(int) override;
  int pack_exchange(int, double *) override;
  int unpack_exchange(int, double *) override;
  double memory_usage() override;

  bool has_sides() const { return rules.sides; }
  int side_of(int owned_atom) const;    // 1 above, -1 below a sheet that is near, 0: none is
  // of all atoms, ghosts too, since the last list build
  const sphcloth::Sides *sides() const { return side.data(); }
  // how far pair_style sph/tait looks
  void set_sight(double distance) { sight = distance; }

 private:
  std::string label;
  ContactRules rules;
  ContactCounts counts;    // of this rank, since the fix was made
  double **places;         // of all atoms at the end of the last step, and BEYOND
  std::vector<std::unique_ptr<ContactSurface>> surfaces;    // one per cloth
  ContactSurface *linking;    // whose halo uses the communication of this fix, null: the sides do
  std::vector<sphcloth::Sides> side;
  double sight;

  bool density_follows_velocity;

  void keep_places();
  void find_sides();
  void show_way();
};

}    // namespace LAMMPS_NS

#endif
#endif
