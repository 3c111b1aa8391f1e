#![no_main]

libfuzzer_sys::fuzz_target!(|noise: &[u8]| jointbench_fuzz::qsb(noise));
