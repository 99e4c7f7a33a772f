#include "core/sph/fluid_loops.h"

template std::unique_ptr<sphcloth::Fluid>
    sphcloth::fluid_of_kernel<sphcloth::WendlandC4>(sphcloth::Precision);
