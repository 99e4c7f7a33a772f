#!/bin/sh
# add_to_lammps.sh LAMMPS: makes SPHCLOTH a package of the LAMMPS source tree in the folder LAMMPS.
#
# Copies src/USER-SPHCLOTH and the CMake module of the package, and adds the package's name to three
# lists: of packages and of packages with a module in cmake/CMakeLists.txt, of packages in
# src/Makefile.  May be repeated, also to bring a new version.

set -eu
here=$(cd "$(dirname "$0")" && pwd)
source=$(cd "$here/../../src/USER-SPHCLOTH" && pwd)
lammps=${1:?usage: add_to_lammps.sh LAMMPS, the folder that has LAMMPS\'s src and cmake}

fail() {
  echo "add_to_lammps.sh: $*" >&2
  exit 1
}

# add FILE EXPRESSION LINE: the sed expression makes the first line of FILE that matches the
# basic regular expression LINE name the package, unless a line of FILE does
add() {
  grep -q "$3" "$lammps/$1" || fail "$lammps/$1 has no line '$3': this release of LAMMPS is not known"
  sed -i.old "1,/$3/ $2" "$lammps/$1" && rm "$lammps/$1.old"
}

test -f "$lammps/src/lammps.h" || fail "$lammps/src/lammps.h is missing: give the folder above LAMMPS's src"
rm -rf "$lammps/src/USER-SPHCLOTH"
cp -R "$source" "$lammps/src/USER-SPHCLOTH"
cp "$here/USER-SPHCLOTH.cmake" "$lammps/cmake/Modules/Packages/"
if ! grep -q USER-SPHCLOTH "$lammps/cmake/CMakeLists.txt"; then
  add cmake/CMakeLists.txt 's/^set(STANDARD_PACKAGES/& USER-SPHCLOTH/' '^set(STANDARD_PACKAGES'
  add cmake/CMakeLists.txt 's/^foreach(PKG_WITH_INCL/& USER-SPHCLOTH/' '^foreach(PKG_WITH_INCL'
fi
if ! grep -q user-sphcloth "$lammps/src/Makefile"; then
  add src/Makefile 's/^PACKAGE = /&user-sphcloth /' '^PACKAGE = '
fi
echo "SPHCLOTH is a package of $lammps: build it with 'cmake -D PKG_USER-SPHCLOTH=on' and the packages"
echo "SPH and MOLECULE, or with 'make yes-user-sphcloth yes-sph yes-molecule' in src"
