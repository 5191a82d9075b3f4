//! Tests of the interface for C: programs in C that are compiled and run, and the functions called as C calls them.

mod allocations;
mod calls;
mod programs;
mod support;
