#!/bin/sh
# Install.sh 0|1|2: takes the package out of LAMMPS's src, puts it in, or brings it up to date.  LAMMPS's
# make calls it in this folder, for make no-user-sphcloth, yes-user-sphcloth and package-update.
#
# LAMMPS compiles the sources at the top of src.  What lies in subfolders gets a source of one line
# there, sphcloth_FOLDER_NAME.cpp.  EIGEN3_INCLUDE is the folder of Eigen's headers; where it is
# empty, pkg-config is asked.

set -eu
LC_ALL=C
export LC_ALL
mode=$1
cd "$(dirname "$0")"
package=$(basename "$PWD")

# the sources in subfolders: cloth/substepping.cpp
below() { find . -mindepth 2 -name '*.cpp' | sed 's|^\./||' | sort; }

# put FILE: the standard input, if FILE has not that already, so that make compiles what has changed
put() {
  cat > ../sphcloth.new
  if cmp -s ../sphcloth.new "../$1"; then rm ../sphcloth.new; else mv ../sphcloth.new "../$1"; fi
}

remove() {
  for file in *.cpp *.h; do rm -f "../$file"; done
  rm -f ../sphcloth_*.cpp
}

install() {
  for file in *.cpp *.h; do put "$file" < "$file"; done
  for file in ../sphcloth_*.cpp; do    # of what is no more
    test ! -f "$file" || test -f "$(sed 's/.*"\(.*\)"/\1/' "$file")" || rm "$file"
  done
  below | while read -r file; do
    printf '#include "%s"\n' "$file" | put "sphcloth_$(echo "$file" | tr / _)"
  done
}

# yyyymmdd of the release that version.h names
release() {
  months=JanFebMarAprMayJunJulAugSepOctNovDec
  set -- $(sed -n 's/.*LAMMPS_VERSION[^"]*"\([0-9]*\) \([A-Z][a-z][a-z]\)[a-z]* \([0-9]*\)".*/\1 \2 \3/p' ../version.h)
  before=${months%%"$2"*}
  printf '%04d%02d%02d\n' "$3" $((${#before} / 3 + 1)) "$1"
}

eigen() {
  if test -n "${EIGEN3_INCLUDE:-}"; then
    echo "-I$EIGEN3_INCLUDE"
  else
    pkg-config --cflags-only-I eigen3 2> /dev/null || echo -I/usr/include/eigen3
  fi
}

# Settings of the compiler stand between two marks, in PKG_INC of Makefile.package.
settings() {
  test -f ../Makefile.package || return 0
  sed -i.old -e 's/ *-DSPHCLOTH_BEGIN.*-DSPHCLOTH_END//' ../Makefile.package
  if test "$1" = 1; then
    flags="-DSPHCLOTH_BEGIN -I.. -I../$package $(eigen) -DSPHCLOTH_LAMMPS_VERSION=$(release)"
    flags="$flags -fopenmp-simd -fno-math-errno -fno-trapping-math -DSPHCLOTH_END"
    sed -i.old -e "s|^PKG_INC =.*|& $flags|" ../Makefile.package
  fi
  rm -f ../Makefile.package.old
}

case $mode in
  0) remove; settings 0 ;;
  1) install; settings 1 ;;
  2) if test -f ../pair_sph_tait.h; then install; settings 1; fi ;;
  *) echo "usage: Install.sh 0|1|2" >&2; exit 2 ;;
esac
