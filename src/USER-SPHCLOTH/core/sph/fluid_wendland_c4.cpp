// SPDX-License-Identifier: GPL-2.0-or-later
// The loops for Wendland C4.

#include "core/sph/density_loops.h"
#include "core/sph/force_loops.h"
#include "core/sph/rate_loops.h"
#include "core/sph/stiffness_loops.h"
#include "core/sph/surface_loops.h"
#include "core/sph/viscosity_loops.h"

template std::unique_ptr<sphcloth::Fluid>
    sphcloth::fluid_of_kernel<sphcloth::WendlandC4>(sphcloth::Precision);
