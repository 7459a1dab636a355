//! Coorg and Teller's method against brute force and exact arithmetic.
