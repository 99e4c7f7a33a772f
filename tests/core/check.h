// The smallest test driver that serves: named cases that register themselves, checks that count.

#ifndef SPHCLOTH_TESTS_CHECK_H
#define SPHCLOTH_TESTS_CHECK_H

#include <cmath>
#include <cstdio>
#include <functional>
#include <string>
#include <utility>
#include <vector>

struct Case {
  std::string name;
  std::function<void()> body;
};

inline std::vector<Case> &cases()
{
  static std::vector<Case> all;
  return all;
}

inline int &failures()
{
  static int n = 0;
  return n;
}

struct Register {
  Register(std::string name, std::function<void()> body)
  {
    cases().push_back({std::move(name), std::move(body)});
  }
};

inline void report(bool ok, const char *file, int line, const std::string &what)
{
  if (ok) return;
  failures()++;
  std::printf("  %s:%d: %s\n", file, line, what.c_str());
}

#define JOIN_(a, b) a##b
#define JOIN(a, b) JOIN_(a, b)
#define CASE(name)                                                              \
  static void JOIN(case_, __LINE__)();                                          \
  static const Register JOIN(register_, __LINE__)(name, JOIN(case_, __LINE__)); \
  static void JOIN(case_, __LINE__)()

#define CHECK(condition) report((condition), __FILE__, __LINE__, #condition)
#define CHECK_NEAR(a, b, tolerance)                                                     \
  do {                                                                                  \
    const double a_ = (a), b_ = (b);                                                    \
    report(std::fabs(a_ - b_) <= (tolerance), __FILE__, __LINE__,                       \
           std::string(#a " = ") + std::to_string(a_) + ", not " + std::to_string(b_)); \
  } while (0)

#endif
