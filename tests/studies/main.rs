//! Studies from file to report: what is read, run, tested, judged, drawn and written; and the pages against the code.

mod claims;
mod figures;
mod input_page;
mod notation;
mod report;
mod runner;
mod statistics;
