// SPDX-License-Identifier: GPL-2.0-or-later
// What a style keeps in restart files: plain records behind their length and a mark.  LAMMPS hands
// those of a fix back by ID and style, without their length; these two tell records of another
// release.

#ifndef SPHCLOTH_LAMMPS_UTIL_RESTART_RECORD_H
#define SPHCLOTH_LAMMPS_UTIL_RESTART_RECORD_H

#include "error.h"

#include <cstdint>
#include <cstdio>
#include <cstring>
#include <string>
#include <type_traits>
#include <vector>

namespace LAMMPS_NS {

static constexpr std::uint32_t RECORD_MARK = 0x53504843;    // SPHC

struct RecordHead {
  std::uint32_t mark, bytes;
};

// on the rank that writes

template <class Record> void write_records(FILE *fp, const std::vector<Record> &records)
{
  static_assert(std::is_trivially_copyable_v<Record>);
  const std::size_t size = sizeof(Record) * records.size();
  const RecordHead head{RECORD_MARK, static_cast<std::uint32_t>(size)};
  const int bytes = static_cast<int>(sizeof(head) + size);
  fwrite(&bytes, sizeof(int), 1, fp);
  fwrite(&head, sizeof(head), 1, fp);
  fwrite(records.data(), size, 1, fp);
}

template <class Record> void write_record(FILE *fp, const Record &record)
{
  write_records(fp, std::vector<Record>{record});
}

template <class Record>
std::vector<Record> read_records(const char *buf, std::size_t count, const std::string &style,
                                 Error *error)
{
  RecordHead head;
  std::memcpy(&head, buf, sizeof(head));
  if (head.mark != RECORD_MARK || head.bytes != count * sizeof(Record))
    error->all(FLERR,
               "{}: its record in the restart file is damaged, or of another release of sphcloth: "
               "take another file, or give the fix another ID to begin anew",
               style);
  std::vector<Record> records(count);
  std::memcpy(records.data(), buf + sizeof(head), head.bytes);
  return records;
}

template <class Record> Record read_record(const char *buf, const std::string &style, Error *error)
{
  return read_records<Record>(buf, 1, style, error).front();
}

}    // namespace LAMMPS_NS

#endif
