// fix cloth/contact: particles do not pass through cloth.

#ifdef FIX_CLASS
// clang-format off
FixStyle(cloth/contact,FixClothContact);
// clang-format on
#else

#ifndef LMP_FIX_CLOTH_CONTACT_H
#define LMP_FIX_CLOTH_CONTACT_H

#include "fix.h"

#include "core/box_grid.h"
#include "core/contact.h"
#include "vertex_halo.h"

#include <array>
#include <string>
#include <vector>

namespace LAMMPS_NS {

class FixPBDCloth;

class FixClothContact : public Fix {
 public:
  FixClothContact(class LAMMPS *, int, char **);
  int setmask() override;
  void init() override;
  void setup_post_neighbor() override;
  void post_neighbor() override;
  void post_integrate() override;
  double compute_vector(int) override;
  int pack_forward_comm(int, int *, double *, int, int *) override;
  void unpack_forward_comm(int, int, double *) override;
  double memory_usage() override;

 private:
  using Vec3 = Eigen::Vector3d;

  struct Contact {
    int particle, triangle;
    sphcloth::Touch touch;
  };

  std::string label;
  double thickness;
  int max_passes;
  std::vector<FixPBDCloth *> cloths;
  VertexHalo halo;
  std::vector<std::array<int, 3>> triangles;    // slots
  std::vector<double> w;                        // inverse masses of the slots
  std::vector<Vec3> start, end;                 // positions of the slots over the step
  std::vector<Vec3> change;                     // of the velocities of the slots, in one pass
  std::vector<Vec3> share;                      // contacts on each slot
  std::vector<int> particle_share;              // contacts on each particle, by atom index
  std::vector<sphcloth::Box> boxes;
  sphcloth::BoxGrid grid;
  std::vector<Contact> contacts;

  enum Count { CONTACTS, STOPS, CROSSED, N_COUNTS };
  double counts[N_COUNTS];    // of this rank, since the fix was made
  double deepest;
  double impulse[3];    // what the pinned vertices took up, this rank

  void add_triangles(const FixPBDCloth &, const std::vector<int> &);
  void check_reach();
  void load_vertices();
  void move_vertices();
  sphcloth::Sweep particle_sweep(int) const;
  std::array<sphcloth::Sweep, 3> triangle_sweep(int) const;
  bool find_contacts(double);
  double particle_inverse_mass(int) const;
  void count_shares();
  void resolve();
  void stop_particles();
  void push_vertices(const Contact &, const Vec3 &);
  void change_velocities();
};

}    // namespace LAMMPS_NS

#endif
#endif
