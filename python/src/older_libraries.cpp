// Parts of newer system libraries that the other sources use. With them the library loads on
// systems with glibc 2.28 and the libstdc++ of GCC 8 (manylinux_2_28), wherever it was built.
#include <new>
#include <sstream>

namespace std {
// Members of string streams that libstdc++ exports since GCC 9 and 11.
template class basic_stringbuf<char>;
template class basic_ostringstream<char>;
template class basic_stringstream<char>;

/// libstdc++ has it since GCC 11.
void __throw_bad_array_new_length() {
    throw bad_array_new_length();
}
}  // namespace std

extern "C" {
/// glibc has it since 2.32. 0 means that the process may have several threads.
char __libc_single_threaded = 0;
}
