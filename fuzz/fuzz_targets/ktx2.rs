#![no_main]

gonio_fuzz::target!("ktx2");
