#include "check.h"

int main()
{
  int failed = 0;
  for (const Case &test : cases()) {
    const int before = failures();
    test.body();
    if (failures() == before) continue;
    failed++;
    std::printf("FAILED %s\n", test.name.c_str());
  }
  std::printf("%zu passed, %d failed\n", cases().size() - failed, failed);
  return failed ? 1 : 0;
}
