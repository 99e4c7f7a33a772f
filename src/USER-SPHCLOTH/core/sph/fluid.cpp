// SPDX-License-Identifier: GPL-2.0-or-later
// What does not depend on kernel and precision: their choice, active particles, counts.

#include "core/sph/fluid.h"

namespace sphcloth {

template <class K> std::unique_ptr<Fluid> fluid_of_kernel(Precision precision);
extern template std::unique_ptr<Fluid> fluid_of_kernel<WendlandC2>(Precision);
extern template std::unique_ptr<Fluid> fluid_of_kernel<WendlandC4>(Precision);
extern template std::unique_ptr<Fluid> fluid_of_kernel<CubicSpline>(Precision);
extern template std::unique_ptr<Fluid> fluid_of_kernel<QuinticSpline>(Precision);

std::unique_ptr<Fluid> Fluid::create(KernelName kernel, Precision precision)
{
  return with_kernel(kernel, [&](auto k) { return fluid_of_kernel<decltype(k)>(precision); });
}

void Fluid::list(const Particles &p, const double *support, double skin, const Motion &motion)
{
  all_selected = false;
  lists.build(points(p), support, skin, motion);
}

bool Fluid::select(const Particles &p)
{
  if (all_selected && !p.active) return false;
  all_selected = !p.active;
  selection.slots.clear();
  selection.first.assign(model.n_types + 2, 0);
  for (int t = 1; t <= model.n_types; t++) {
    selection.first[t] = selection.slots.size();
    const bool all = !p.active || model.role[t] != Role::FLUID;
    for (int slot = lists.begin(t); slot < lists.begin(t + 1); slot++)
      if (all || p.is_active(lists.at(slot))) selection.slots.push_back(slot);
  }
  selection.first[model.n_types + 1] = selection.slots.size();
  return true;
}

void Fluid::find_touched(const Particles &p)
{
  // reading them one by one costs more than all of them in their order
  constexpr std::size_t MANY = 12;
  few_touched = MANY * selection.slots.size() < static_cast<std::size_t>(p.n_owned);
  if (!few_touched) return;
  for (const int i : touched_particles) is_touched[i] = 0;
  touched_particles.clear();
  is_touched.resize(p.n_all);
  const auto add = [this](int i) {
    if (is_touched[i]) return;
    is_touched[i] = 1;
    touched_particles.push_back(i);
  };
  for (const int slot : selection.slots) {
    add(lists.at(slot));
    lists.refresh(slot);
    for (const int t : lists.present_types()) {
      const NeighborSpan near = lists(slot, t);    // with what fills up its last group
      for (int k = 0; k < whole_groups(near.n); k++) add(near.of[k]);
    }
  }
}

int Fluid::count_inside(const Particles &p, int owned, int type, int max) const
{
  const double support_sq = model.pair(p.type[owned], type).kernel.support_sq;
  const NeighborSpan list = lists.without_pruning(lists.slot(owned), type);
  const double *x = p.x + 3 * owned;
  int n = 0;
  for (int k = 0; k < list.n && n < max; k++) {
    const double *y = p.x + 3 * list.of[k];
    const double dx = x[0] - y[0], dy = x[1] - y[1], dz = x[2] - y[2];
    n += dx * dx + dy * dy + dz * dz < support_sq;
  }
  return n;
}

}    // namespace sphcloth
