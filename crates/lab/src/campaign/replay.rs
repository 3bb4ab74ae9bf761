//! Reading a plan: the inputs of every flight from `plan.csv`.

use super::random::{key, named};
use super::result::Input;

/// Seeds and inputs of a plan in the order of `inputs`, each with whether it is a name and no number.
///
/// # Errors
/// What is wrong with it, with its line.
pub fn rows(plan: &str, inputs: &[(String, bool)]) -> Result<Vec<(u64, Vec<Input>)>, String> {
    let mut lines = plan.lines().enumerate().map(|(i, line)| (i + 1, line));
    let head = lines.next().map_or_else(Vec::new, |(_, line)| cells(line));
    let place = |name: &str| {
        head.iter()
            .position(|cell| cell == name)
            .ok_or_else(|| format!("line 1: no column `{name}`"))
    };
    let (index_at, seed_at) = (place("index")?, place("seed")?);
    let places = inputs.iter().map(|(name, _)| place(name)).collect::<Result<Vec<_>, _>>()?;
    if let Some(extra) = head
        .iter()
        .enumerate()
        .find(|(at, _)| *at != index_at && *at != seed_at && !places.contains(at))
    {
        return Err(format!("line 1: column `{}` is no input of the scenario", extra.1));
    }
    let mut rows = Vec::new();
    for (number, line) in lines {
        let row = cells(line);
        if row.len() != head.len() {
            let (has, wants) = (row.len(), head.len());
            return Err(format!("line {number}: {has} cells: the head has {wants}"));
        }
        let whole = |at: usize, what: &str| {
            row[at]
                .parse::<u64>()
                .map_err(|_| format!("line {number}: {what} `{}` is no whole number", row[at]))
        };
        if whole(index_at, "index")? != rows.len() as u64 {
            return Err(format!("line {number}: index `{}` must be {}", row[index_at], rows.len()));
        }
        let seed = whole(seed_at, "seed")?;
        if seed > 9_000_000_000_000_000 {
            return Err(format!("line {number}: seed `{seed}` must be at most 9e15"));
        }
        let input = |(at, (_, named)): (&usize, &(String, bool))| match row[*at].parse::<f64>() {
            _ if *named => Ok(Input::Text(row[*at].clone())),
            Ok(x) if x.is_finite() => Ok(Input::Number(x)),
            Ok(x) => Err(format!("line {number}: `{}` = {x}: must be finite", head[*at])),
            Err(_) => {
                Err(format!("line {number}: `{}` = `{}`: must be a number", head[*at], row[*at]))
            }
        };
        rows.push((seed, places.iter().zip(inputs).map(input).collect::<Result<_, _>>()?));
    }
    if rows.is_empty() { Err("no flights".into()) } else { Ok(rows) }
}

/// The cells of a line; quotes as `plan.csv` writes them.
fn cells(line: &str) -> Vec<String> {
    let (mut cells, mut cell, mut quoted) = (Vec::new(), String::new(), false);
    let mut letters = line.chars().peekable();
    while let Some(letter) = letters.next() {
        match letter {
            '"' if quoted && letters.peek() == Some(&'"') => {
                cell.push('"');
                letters.next();
            }
            '"' => quoted = !quoted,
            ',' if !quoted => cells.push(std::mem::take(&mut cell)),
            _ => cell.push(letter),
        }
    }
    cells.push(cell);
    cells
}

/// A number that tells two plans apart.
pub fn hash(rows: &[(u64, Vec<Input>)]) -> u64 {
    rows.iter().fold(0, |state, (seed, inputs)| {
        inputs.iter().fold(key(state, *seed), |state, input| match input {
            Input::Number(x) => key(state, x.to_bits()),
            Input::Text(text) => named(state, text),
        })
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_are_found_by_name_and_quotes_taken_off() {
        let names = [("b,c".to_owned(), false), ("law".to_owned(), true)];
        let plan = "seed,law,index,\"b,c\"\n7,hosm,0,1e-3\n8,none,1,2.5\n";
        let read = rows(plan, &names).expect("a good plan");
        let row = |seed, x, law: &str| (seed, vec![Input::Number(x), Input::Text(law.into())]);
        assert_eq!(read, [row(7, 1e-3, "hosm"), row(8, 2.5, "none")]);
        // A name may look like a number.
        let plan = "index,seed,law,\"b,c\"\n0,7,0.50,1\n1,8,\"[1, 0, 0]\",2\n";
        let read = rows(plan, &names).expect("a good plan");
        assert_eq!(read, [row(7, 1.0, "0.50"), row(8, 2.0, "[1, 0, 0]")]);
    }

    #[test]
    fn what_is_wrong_is_said_with_its_line() {
        let names = [("m".to_owned(), false)];
        for (plan, message) in [
            ("", "line 1: no column `index`"),
            ("index,seed\n", "line 1: no column `m`"),
            ("index,seed,m,n\n", "line 1: column `n` is no input of the scenario"),
            ("index,seed,m\n", "no flights"),
            ("index,seed,m\n0,1\n", "line 2: 2 cells: the head has 3"),
            ("index,seed,m\n1,1,1\n", "line 2: index `1` must be 0"),
            ("index,seed,m\n0,x,1\n", "line 2: seed `x` is no whole number"),
            ("index,seed,m\n0,1,inf\n", "line 2: `m` = inf: must be finite"),
            ("index,seed,m\n0,1,2\n1,1, 2\n", "line 3: `m` = ` 2`: must be a number"),
        ] {
            assert_eq!(rows(plan, &names), Err(message.to_owned()));
        }
    }
}
