//! The libraries for C and C++ (`libetendue.so`, `libetendue.a`): the crate with its feature `capi`, whose exported functions
//! `include/etendue.h` declares. `scripts/install.sh` builds them and gives them their names.

extern crate etendue as _;
