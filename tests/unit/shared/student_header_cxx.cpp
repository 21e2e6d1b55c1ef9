// Exported header in C++: its hashes are those of the arrays, which exported_student.h asserts at
// compile time.
#include "shared/nn/exported_student.h"
#include "student_header_check.h"

int main() { return check_student_header() + bess::count_exported_self_check_failures(); }
