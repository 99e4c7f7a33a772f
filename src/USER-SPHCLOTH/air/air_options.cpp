// SPDX-License-Identifier: GPL-2.0-or-later
// Reads the keywords of fix cloth/air and its table of coefficients.

#include "air/air_options.h"

#include "comm.h"
#include "error.h"
#include "lammps_util/arg_reader.h"

#include <cmath>
#include <cstdio>
#include <sstream>
#include <vector>

using namespace LAMMPS_NS;

static constexpr double RADIANS = 3.14159265358979323846 / 180.0;

void AirOptions::read(ArgReader &args)
{
  bool has_density = false, has_coefficients = false;
  std::string table;
  while (args.more()) {
    const std::string keyword = args.word("keyword");
    if (keyword == "density") {
      drag.density = args.positive("density");
      has_density = true;
    } else if (keyword == "wind")
      wind.read_mean(args);
    else if (keyword == "gust")
      wind.read_gust(args);
    else if (keyword == "shaded")
      shaded = args.choice(keyword, {"no", "yes"});
    else if (keyword == "added_mass")
      added_thickness = args.at_least("added_mass", 0.0);
    else if (keyword == "normal" || keyword == "tangential") {
      const bool normal = keyword == "normal";
      (normal ? drag.coefficients.normal : drag.coefficients.tangential) =
          args.at_least(keyword, 0.0);
      has_coefficients = true;
    } else if (keyword == "table")
      table = args.word("file of 'table'");
    else
      args.unknown(keyword, "density, wind, gust, normal, tangential, table, shaded, added_mass");
  }
  if (!has_density)
    error->all(FLERR,
               "{}: 'density' is missing: give that of the air, which is 1.2 kg/m^3 at sea level",
               owner);
  if (!table.empty() && has_coefficients)
    error->all(FLERR, "{}: 'table' stands for 'normal' and 'tangential': give one or the other",
               owner);
  if (!table.empty()) read_table(table);
}

// On rank 0: angle in degrees, drag and lift, a row each.

static std::string read_rows(const std::string &file, std::vector<double> &numbers)
{
  FILE *fp = fopen(file.c_str(), "r");
  if (!fp) return "cannot be read: give the name of a file with rows of angle, drag and lift";
  constexpr int SIZE = 1024;
  char text[SIZE];
  std::string wrong;
  for (int line = 1; wrong.empty() && fgets(text, SIZE, fp); line++) {
    std::istringstream stream(utils::trim_comment(text));
    std::vector<std::string> words;
    for (std::string word; stream >> word;) words.push_back(word);
    if (words.empty()) continue;
    bool valid = words.size() == 3;
    for (const std::string &word : words) valid = valid && utils::is_double(word);
    if (!valid) {
      wrong = fmt::format("line {} is not three numbers: give angle, drag and lift", line);
      break;
    }
    for (const std::string &word : words) numbers.push_back(std::strtod(word.c_str(), nullptr));
    const double *row = &numbers[numbers.size() - 3];
    if (!std::isfinite(row[0] + row[1] + row[2]))
      wrong = fmt::format("line {} holds a number that is not finite", line);
    else if (numbers.size() > 3 && !(row[0] > row[-3]))
      wrong = fmt::format("the angle in line {} is not above the one before: sort them", line);
    else if (row[1] < 0.0)
      wrong = fmt::format("the drag in line {} is negative: it must be >= 0", line);
  }
  fclose(fp);
  const std::size_t n = numbers.size();
  if (wrong.empty() && (n < 6 || numbers[0] != 0.0 || numbers[n - 3] != 90.0))
    wrong = "its angles must go from 0, along the sheet, to 90 degrees, across";
  return wrong;
}

void AirOptions::read_table(const std::string &file)
{
  std::vector<double> numbers;
  std::string wrong;
  if (comm->me == 0) wrong = read_rows(file, numbers);
  int sizes[2] = {static_cast<int>(numbers.size()), static_cast<int>(wrong.size())};
  MPI_Bcast(sizes, 2, MPI_INT, 0, world);
  wrong.resize(sizes[1]);
  MPI_Bcast(&wrong[0], sizes[1], MPI_CHAR, 0, world);
  if (!wrong.empty()) error->all(FLERR, "{}: table is '{}': {}", owner, file, wrong);
  numbers.resize(sizes[0]);
  MPI_Bcast(numbers.data(), sizes[0], MPI_DOUBLE, 0, world);
  std::vector<sphcloth::DragTable::Row> rows;
  for (std::size_t k = 0; k < numbers.size(); k += 3)
    rows.push_back({RADIANS * numbers[k], numbers[k + 1], numbers[k + 2]});
  drag.table = sphcloth::DragTable(std::move(rows));
}
