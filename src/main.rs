//! cullscope, the program.

fn main() {}
