# sphcloth::core: numerics without LAMMPS, headers only.

add_library(sphcloth_core INTERFACE)
add_library(sphcloth::core ALIAS sphcloth_core)
target_include_directories(sphcloth_core INTERFACE "${CMAKE_CURRENT_LIST_DIR}/../src/USER-SPHCLOTH")
target_link_libraries(sphcloth_core INTERFACE Eigen3::Eigen)
# Vectors without a second OpenMP runtime; errno and trapping semantics would keep square roots
# and branches out of vectors.  Results stay IEEE: no reassociation beyond `omp simd reduction`.
target_compile_options(sphcloth_core INTERFACE
  -fopenmp-simd -fno-math-errno -fno-trapping-math)
