#![no_main]

gonio_fuzz::target!("npy");
