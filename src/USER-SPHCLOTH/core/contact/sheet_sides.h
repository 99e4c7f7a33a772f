// SPDX-License-Identifier: GPL-2.0-or-later
// On which side of each sheet a particle is, for sheets that are near it.

#ifndef SPHCLOTH_CORE_CONTACT_SHEET_SIDES_H
#define SPHCLOTH_CORE_CONTACT_SHEET_SIDES_H

#include <cstdint>

namespace sphcloth {

// bits 0 to 7: above sheet 0 to 7, the side from which its triangles run counter-clockwise;
// bits 8 to 15: below it

using Sides = std::uint16_t;

inline constexpr int MAX_SHEETS = 8;

inline Sides side_of_sheet(int sheet, bool above)
{
  return static_cast<Sides>(1u << (above ? sheet : sheet + MAX_SHEETS));
}

// is there a sheet between the two?

inline bool parted(Sides a, Sides b)
{
  const unsigned above_a = a & 0xffu, below_a = a >> MAX_SHEETS;
  const unsigned above_b = b & 0xffu, below_b = b >> MAX_SHEETS;
  return ((above_a & below_b) | (below_a & above_b)) != 0;
}

}    // namespace sphcloth

#endif
