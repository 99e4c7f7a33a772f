// SPDX-License-Identifier: GPL-2.0-or-later
// For a library that also runs where the C library is older than here, as manylinux_2_28 asks: put
// before every source by SPHCLOTH_OLD_SYMBOLS.  The C library gave these functions a second version,
// which differs from the first in how it reports errors; the first is there everywhere.

#if defined(__x86_64__)
#define SPHCLOTH_FIRST "GLIBC_2.2.5"
#elif defined(__aarch64__)
#define SPHCLOTH_FIRST "GLIBC_2.17"
#endif

#ifdef SPHCLOTH_FIRST
__asm__(".symver exp,exp@" SPHCLOTH_FIRST);
__asm__(".symver exp2,exp2@" SPHCLOTH_FIRST);
__asm__(".symver log,log@" SPHCLOTH_FIRST);
__asm__(".symver log2,log2@" SPHCLOTH_FIRST);
__asm__(".symver pow,pow@" SPHCLOTH_FIRST);
__asm__(".symver hypot,hypot@" SPHCLOTH_FIRST);
#endif
