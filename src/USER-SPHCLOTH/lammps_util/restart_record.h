// SPDX-License-Identifier: GPL-2.0-or-later
// What a fix keeps in restart files: one plain record behind its length and a mark.  LAMMPS hands
// it back by ID and style, without its length; a record of another release is told by these two.

#ifndef SPHCLOTH_LAMMPS_UTIL_RESTART_RECORD_H
#define SPHCLOTH_LAMMPS_UTIL_RESTART_RECORD_H

#include "error.h"

#include <cstdint>
#include <cstdio>
#include <cstring>
#include <string>
#include <type_traits>

namespace LAMMPS_NS {

static constexpr std::uint32_t RECORD_MARK = 0x53504843;    // SPHC

struct RecordHead {
  std::uint32_t mark, bytes;
};

// on the rank that writes

template <class Record> void write_record(FILE *fp, const Record &record)
{
  static_assert(std::is_trivially_copyable_v<Record>);
  const RecordHead head{RECORD_MARK, static_cast<std::uint32_t>(sizeof(Record))};
  const int bytes = static_cast<int>(sizeof(head) + sizeof(Record));
  fwrite(&bytes, sizeof(int), 1, fp);
  fwrite(&head, sizeof(head), 1, fp);
  fwrite(&record, sizeof(Record), 1, fp);
}

template <class Record> Record read_record(const char *buf, const std::string &style, Error *error)
{
  RecordHead head;
  std::memcpy(&head, buf, sizeof(head));
  if (head.mark != RECORD_MARK || head.bytes != sizeof(Record))
    error->all(FLERR,
               "{}: its record in the restart file is damaged, or of another release of sphcloth: "
               "take another file, or give the fix another ID to begin anew",
               style);
  Record record;
  std::memcpy(&record, buf + sizeof(head), sizeof(Record));
  return record;
}

}    // namespace LAMMPS_NS

#endif
