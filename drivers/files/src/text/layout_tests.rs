use super::*;
use crate::text::Stamp;

fn names(layout: &Layout) -> Vec<&str> {
    layout.columns.iter().filter(|c| c.content != Content::Empty).map(|c| c.name.as_str()).collect()
}

fn of(text: &str) -> Layout {
    Layout::of(text.as_bytes(), true, None)
}

#[test]
fn separators_are_those_that_make_numbers() {
    for (text, separator) in [
        ("t,x\n0,1\n1,2\n", Separator::Sign(b',')),
        ("t;x\n0,5;1,5\n1;2\n", Separator::Sign(b';')),
        ("t\tx\n0,5\t1,5\n", Separator::Sign(b'\t')),
        ("t|x\n0|1\n", Separator::Sign(b'|')),
        ("  t   x\n  0   1.5\n  1   2.5\n", Separator::Blanks),
        ("t, x\n0, 1\n1, 2\n", Separator::Sign(b',')),
        ("sep=;\nt;x\n0;1\n", Separator::Sign(b';')),
        ("Date and Time,x\n2026-01-02 10:00:00.005,1\n2026-01-02 10:00:00.010,2\n", Separator::Sign(b',')),
        ("t,\"v; w\"\n0,1\n", Separator::Sign(b',')),
    ] {
        assert_eq!(of(text).separator, separator, "{text}");
    }
}

#[test]
fn names_stand_above_the_rows_and_below_everything_else() {
    for (text, expected, start_line) in [
        ("t,x\n0,1\n1,2\n", &["t", "x"][..], 2),
        ("2026-01-02 15:22\nt,x\n0,1\n1,2\n", &["t", "x"], 3),
        ("# a\n# b, c\nt,x\n0,1\n", &["t", "x"], 4),
        ("# t x\n0 1\n1 2\n", &["t", "x"], 2),
        ("Rate,1000\nOperator,N\n\nt,x\n0,1\n1,2\n2,3\n", &["t", "x"], 5),
        ("Test, joint 3, warm\nt,x,y\n0,1,2\n", &["t", "x", "y"], 3),
        ("t,x,\n0,1,\n1,2,\n", &["t", "x"], 2),
        ("t,x\n0,1,\n1,2,\n", &["t", "x"], 2),
        (",t,x\n0,0,1\n1,1,2\n", &["", "t", "x"], 2),
        ("t x\n1 0 5\n2 1 6\n", &["", "t", "x"], 2),
        ("t,x,remark\n0,1,cold\n1,2,warm\n", &["t", "x", "remark"], 2),
    ] {
        let layout = of(text);
        assert_eq!(names(&layout), expected, "{text}");
        assert_eq!(layout.start_line, start_line, "{text}");
    }
    assert_eq!(of("0,1\n1,2\n").names_line, None);
    assert_eq!(of("time_s\tx\tComment\n0\t1\n1\t2\n").extra_names, ["Comment"]);
}

#[test]
fn a_line_of_units_is_no_line_of_names() {
    let layout = of("t,x\ns,rad\n0,1\n");
    assert_eq!((names(&layout), layout.units_line, layout.start_line), (vec!["t", "x"], Some(2), 3));
    assert_eq!(layout.columns[1].unit.as_deref(), Some("rad"));
    let layout = of("x-axis,1,2\nsecond,Volt,A\n0,1,2\n1,2,3\n");
    assert_eq!((names(&layout), layout.columns[2].unit.as_deref()), (vec!["x-axis", "1", "2"], Some("A")));
    let layout = of("# t x\n# [s] [rad]\n0 1\n");
    assert_eq!((names(&layout), layout.columns[1].unit.as_deref()), (vec!["t", "x"], Some("rad")));
    let layout = of("Time,Current,Torque,Speed\ns,mA,N.mm,rad.s\n0,1,2,3\n1,2,3,4\n2,3,4,5\n");
    assert_eq!((names(&layout)[3], layout.columns[2].unit.as_deref()), ("Speed", Some("N.mm")), "one unknown unit");
    assert_eq!(layout.columns[3].unit.as_deref(), Some("rad.s"));
    assert_eq!(names(&of("s,V\n0,1\n")), ["s", "V"], "where nothing else names them");
}

#[test]
fn a_block_of_lines_says_what_each_of_them_holds() {
    let expected = (vec!["phi", "n"], Some("rpm"));
    for (text, start_line) in [
        ("path,a/phi,a/n\nname,phi,n\nunit,rad,rpm\n,,\n,0.5,1\n,0.6,2\n,0.7,3\n", 5),
        ("\tphi\tn\nunit_string\trad\trpm\nDatatype\tDBL\tDBL\nLength\t3\t3\n\t0.5\t1\n\t0.6\t2\n\t0.7\t3\n", 5),
        ("TraceName,phi,n\nBlockSize,3,3\nVUnit,rad,rpm\nHUnit,s,s\n,0.5,1,\n,0.6,2,\n,0.7,3,\n", 5),
    ] {
        let layout = of(text);
        let named = layout.columns.iter().filter(|column| !column.name.is_empty());
        let units: Vec<Option<&str>> = named.map(|column| column.unit.as_deref()).collect();
        assert_eq!((names(&layout), units[1]), expected, "{text}");
        assert_eq!(layout.start_line, start_line, "{text}");
    }
    let text = "t [s]\tphi [rad]\tn [rpm]\tm [Nm]\nT1\tPMX\tPMX\tPMX\n0,5\t1\t2\t3\n0,6\t2\t3\t4\n0,7\t3\t4\t5\n";
    assert_eq!((names(&of(text))[1], of(text).start_line), ("phi [rad]", 3));
    assert_eq!(
        names(&of("Name;phi;Name;n\nUnit;rad;Unit;rpm\n0;1;0;2\n5;2;5;3\n9;3;9;4\n")),
        ["Name", "phi", "Name", "n"]
    );
    let text = "Name;a log;\nName;phi;n\nUnit;(None);(None)\nOffset;0;0\n132900081483250000;1;2\n132900081483350000;2;3\n132900081483450000;3;4\n";
    assert_eq!(names(&of(text)), ["time", "phi", "n"]);
}

#[test]
fn lines_of_groups_and_sparse_columns_leave_the_names_alone() {
    for (text, expected) in [
        // A line of groups above names that come again.
        ("A,,B,,C,\nt,v,t,v,t,v\n0,1,0,2,0,3\n5,1,5,2,5,3\n9,1,9,2,9,3\n", &["t", "v", "t", "v", "t", "v"][..]),
        ("motor,motor,motor,link\nt,v,v,v\n0,1,2,3\n5,1,2,4\n9,1,2,5\n", &["t", "v", "v", "v"]),
        // A sensor that is read now and then, and a column of remarks.
        ("temp,t,x\n20.5,0,1\n,1,2\n,2,3\n,3,4\n21,4,5\n", &["temp", "t", "x"]),
        ("event,t,x\n,0,1\n,1,2\nstart,2,3\n,3,4\n", &["event", "t", "x"]),
        // The first column names the samples, or numbers them while another column is the time.
        ("Name,t,x\nunit,s,rad\nfirst,0,1\nsecond,1,2\nthird,2,3\n", &["Name", "t", "x"]),
        ("Channel,time,x\nunit,s,rad\n1,0,1\n2,1,2\n1,2,3\n", &["Channel", "time", "x"]),
    ] {
        assert_eq!(names(&of(text)), expected, "{text}");
    }
}

#[test]
fn columns_say_what_they_hold() {
    let layout = of("t,on,remark,clock\n0,True,x,10:00:00.5\n1,False,y,10:00:01\n");
    let contents: Vec<Content> = layout.columns.iter().map(|column| column.content).collect();
    let first = Stamp::Clock(36_000_500_000_000);
    assert_eq!(contents, [Content::Numbers, Content::Numbers, Content::Words, Content::Stamps(first)]);
}

#[test]
fn the_decimal_sign_is_what_the_numbers_tell() {
    for (text, decimal) in [
        ("t;x\n0,005;1.220\n0,010;1.230\n", Decimal::Comma),
        ("t;x\n0.005;1\n", Decimal::Point),
        ("t;x\n1.234,5;1\n", Decimal::Comma),
        ("t,x\n0.5,\"1,234\"\n", Decimal::Point),
        ("t,x\n\"0,5\",\"1,25\"\n", Decimal::Comma),
    ] {
        assert_eq!(of(text).decimal, decimal, "{text}");
    }
    assert_eq!(Layout::of(b"t;x\n0,5;1\n", true, Some(Decimal::Point)).decimal, Decimal::Point);
}
