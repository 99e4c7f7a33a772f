#include "check.h"
#include "core/sph/kernel.h"

using namespace sphcloth;

namespace {

double sphere(int dim) { return dim == 3 ? 4.0 * PI : 2.0 * PI; }

template <class K> double value(const KernelScale &s, double r)
{
  return s.w * K::shape(r * s.inv_support);
}

// Simpson's rule over the radius, an even number of pieces that meets q = 1/2
template <class K> double integral(double support, int dim)
{
  const KernelScale s = kernel_scale<K>(support, dim);
  const int n = 4000;
  const double h = support / n;
  double sum = 0.0;
  for (int k = 0; k <= n; k++) {
    const double r = k * h, weight = k == 0 || k == n ? 1.0 : k % 2 ? 4.0 : 2.0;
    sum += weight * sphere(dim) * std::pow(r, dim - 1) * value<K>(s, r);
  }
  return sum * h / 3.0;
}

template <class K> void check_kernel()
{
  for (int dim : {2, 3}) {
    CHECK_NEAR(integral<K>(0.37, dim), 1.0, 1e-10);
    const KernelScale s = kernel_scale<K>(0.37, dim);
    const double peak = value<K>(s, 0.0), d = 1e-6 * 0.37;
    for (double r : {0.02, 0.1, 0.184, 0.186, 0.3, 0.36}) {
      const double slope = (value<K>(s, r + d) - value<K>(s, r - d)) / (2.0 * d);
      CHECK_NEAR(r * s.f * K::slope_over_q(r * s.inv_support) / peak, slope / peak, 1e-7);
      CHECK(K::slope_over_q(r * s.inv_support) < 0.0);
    }
    CHECK(K::shape(1.0) == 0.0);
    CHECK(K::slope_over_q(1.0) == 0.0);
    CHECK(K::shape(1.3) == 0.0);
    CHECK(K::slope_over_q(1.3) == 0.0);
    CHECK(std::isfinite(K::slope_over_q(0.0)));
  }
}

}    // namespace

CASE("every kernel: integral, gradient, support")
{
  for (KernelName name : ALL_KERNELS)
    with_kernel(name, [](auto kernel) { check_kernel<decltype(kernel)>(); });
}

CASE("a kernel is found by its name and only by its own")
{
  for (KernelName a : ALL_KERNELS)
    for (KernelName b : ALL_KERNELS) CHECK((kernel_word(a) == kernel_word(b)) == (a == b));
}

CASE("kernels in single precision agree with double")
{
  for (KernelName name : ALL_KERNELS)
    with_kernel(name, [](auto kernel) {
      using K = decltype(kernel);
      for (double q = 0.0; q < 1.2; q += 0.013) {
        CHECK_NEAR(K::shape(static_cast<float>(q)), K::shape(q), 2e-6 * K::shape(0.0));
        CHECK_NEAR(K::slope_over_q(static_cast<float>(q)), K::slope_over_q(q), 4e-5);
      }
    });
}
