#include "fluid.h"

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

void Fluid::list(const Particles &p, const double *reach)
{
  lists.build(p.x, p.type, p.n_owned, p.n_all, model.n_types, reach);
  slot_of.resize(p.n_owned);
  longest = 0;
  for (int slot = 0; slot < lists.slots(); slot++) {
    slot_of[lists.at(slot)] = slot;
    for (int t = 1; t <= model.n_types; t++) longest = std::max(longest, lists(slot, t).n);
  }
  inside.assign(static_cast<std::size_t>(lists.slots()) * model.n_types, 0);
}

double Fluid::bytes() const
{
  return lists.bytes() + sizeof(int) * static_cast<double>(inside.capacity() + slot_of.capacity());
}

}    // namespace sphcloth
