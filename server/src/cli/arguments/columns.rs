//! Options for reading a measurement file.

use clap::Args;
use jointbench_files::Choices;

/// What to do to a file on its way in. Each message about a file names the option that it needs.
#[derive(Debug, Args)]
#[command(next_help_heading = "Reading the file (docs/your-files.md)")]
pub struct Columns {
    /// Take a column from one of another name, such as motor_current_a=Iq; may be given again
    #[arg(long, value_name = "COLUMN=NAME")]
    pub map: Vec<String>,
    /// Unit of a column in the file, such as motor_position_rad=deg, motor_velocity_rad_s=rpm, time_s=ms or
    /// motor_position_rad=counts/4096 (counts with the counts per turn); may be given again
    #[arg(long, value_name = "COLUMN=UNIT")]
    pub unit: Vec<String>,
    /// Multiply a column, such as motor_velocity_rad_s=-1; may be given again
    #[arg(long, value_name = "COLUMN=FACTOR")]
    pub scale: Vec<String>,
    /// Make an angle continuous that wraps after a turn (or after PERIOD, in the column's SI unit); may be given again
    #[arg(long, value_name = "COLUMN[=PERIOD]")]
    pub unwrap: Vec<String>,
    /// Leave a column of the file out; may be given again. Columns of words stay out by themselves
    #[arg(long, value_name = "NAME")]
    pub leave: Vec<String>,
    /// Omit rows with an empty cell (rejected otherwise) and print their number
    #[arg(long, overrides_with = "leave_empty_rows")]
    pub leave_empty_rows: bool,
    /// Omit lines of a text (rows of a columnar file) as messages count them, such as 17,40-52 or 900- (to the end); may be
    /// given again
    #[arg(long, value_name = "LINES")]
    pub omit_rows: Vec<String>,
    /// What stands for an empty cell, such as OVLD or -9999 (none: no number does); may be given again
    #[arg(long, value_name = "CELL", allow_hyphen_values = true)]
    pub missing: Vec<String>,
    /// Names of the columns, for a table without a line of names
    #[arg(long, value_name = "NAME,NAME,…")]
    pub names: Option<String>,
    /// Decimal sign: point or comma, of all columns or of one (current_ma=comma); the other sign separates thousands
    #[arg(long, value_name = "[NAME=]SIGN")]
    pub decimal: Vec<String>,
    /// Sample rate of a table without a time [Hz]
    #[arg(long, value_name = "HZ")]
    pub rate: Option<f64>,
    /// Ignore the time in the table and count the rows at this sample rate [Hz]
    #[arg(long, value_name = "HZ")]
    pub time_from_rate: Option<f64>,
    /// Spread rows with the same time stamp evenly up to the next one, for a clock that is coarser than the sampling
    #[arg(long)]
    pub spread_time: bool,
    /// Each row is the mean of one steady operating point (speed, current, load): a friction or brake table without a time
    #[arg(long)]
    pub operating_points: bool,
    /// Take a file in which the time begins again as several recordings of one measurement, numbered in column run
    #[arg(long)]
    pub split_runs: bool,
}

impl Columns {
    pub fn choices(&self) -> Choices {
        Choices {
            map: self.map.clone(),
            scale: self.scale.clone(),
            unit: self.unit.clone(),
            unwrap: self.unwrap.clone(),
            leave: self.leave.clone(),
            leave_empty_rows: self.leave_empty_rows,
            omit_rows: self.omit_rows.clone(),
            missing: self.missing.clone(),
            names: self.names.clone(),
            decimal: self.decimal.clone(),
            rate: self.rate,
            time_from_rate: self.time_from_rate,
            spread_time: self.spread_time,
            operating_points: self.operating_points,
            split_runs: self.split_runs,
        }
    }
}
