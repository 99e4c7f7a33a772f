// What stepping schemes have in common.

#include "stepping/stepper.h"

#include "pair_sph_tait.h"

using namespace LAMMPS_NS;

void Stepper::init(PairSPHTait *style)
{
  pair = style;
  tell_active(false);
}

void Stepper::grow(int nmax)
{
  columns().grow(nmax);
  if (pair) tell_active(false);
}

void Stepper::tell_active(bool all)
{
  pair->set_active(all ? nullptr : parts.rows.row, UpdateRows::ACTIVE, interpolates_density());
}
